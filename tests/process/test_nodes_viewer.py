"""kinect_viewer and image_view: lines, files, and a terminal that is given back."""

import io
import json
import os
import pty
import select
import signal
import struct
import subprocess
import termios
import time
from contextlib import closing
from fcntl import ioctl

import lcm
import PIL.Image
import pytest
from fixtures.says import assert_line
from fixtures.typist import Typist
from fixtures.window import LivePage

from lcmtools.types.sensor_msgs import CompressedImage, Image

TOPIC = "/camera/depth/image_raw"


def picture():
    message = Image()
    message.encoding, message.width, message.height, message.step = "16UC1", 8, 6, 16
    message.data = struct.pack("<48H", *range(1000, 1048))
    message.data_length = len(message.data)
    return message


def publish_until_end(process, url, message):
    """A camera, until its reader has had enough."""
    bus = lcm.LCM(url)
    deadline = time.monotonic() + 40
    while process.poll() is None:
        assert time.monotonic() < deadline
        bus.publish(TOPIC, message.encode())
        time.sleep(0.05)


def look(url, path, message, *words):
    """Run a viewer in front of a camera; its exit code and output."""
    with subprocess.Popen(
        [path, "run", *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "LCM_DEFAULT_URL": url},
    ) as process:
        publish_until_end(process, url, message)
        assert process.stdout is not None
        return process.returncode, process.stdout.read().decode()


def test_a_topic_without_a_publisher_is_named_at_once_with_those_that_have_pictures(
    bus_url, lcmtools_path, start
):
    words = (lcmtools_path, "run", "image_view", "--lcm-url", bus_url)
    alone = start(*words, "image:=/camera/rgb")
    alone.wait_for("no node publishes /camera/rgb; lcmtools list shows all")
    values = "{encoding: mono8, width: 1, height: 1, step: 1, data: [7]}"
    camera = ("pub", "-r", "5", "/front/image", "sensor_msgs/Image", values)
    start(lcmtools_path, *camera, "--lcm-url", bus_url).wait_for("publishing")
    other = start(*words, "image:=/camera/rgb")
    other.wait_for("no node publishes /camera/rgb; pictures are on /front/image")
    seen = start(*words, "image:=/front/image", "--once")
    seen.wait_for("1 x 1")
    assert not any("no node publishes" in line for line in seen.lines)


def test_one_line_is_written_where_there_is_no_terminal(bus_url, lcmtools_path):
    assert look(bus_url, lcmtools_path, picture(), "kinect_viewer", "--once") == (
        0,
        "8 x 6 16UC1  min 1.00 m  max 1.05 m  middle 1.03 m\n",
    )


def test_picture_is_saved_with_values_and_with_a_number(bus_url, lcmtools_path, tmp_path):
    file = str(tmp_path / "depth%03d.png")
    words = ("image_view", f"image:={TOPIC}", "--once", "--json", "--values", "--save", file)
    code, output = look(bus_url, lcmtools_path, picture(), *words)
    assert (code, json.loads(output)["file"]) == (0, file.replace("%03d", "000"))
    with PIL.Image.open(tmp_path / "depth000.png") as image:
        assert (image.size, image.mode) == ((8, 6), "I;16")
        assert image.tobytes() == struct.pack("<48H", *range(1000, 1048))


def test_compressed_picture_is_shown_and_a_broken_one_is_one_line(bus_url, lcmtools_path):
    message = CompressedImage()
    message.format = "png"
    message.data = encode_png_of_depth()
    message.data_length = len(message.data)
    words = ("kinect_viewer", "--once")
    assert look(bus_url, lcmtools_path, message, *words)[1].startswith("2 x 1 16UC1  min 0.70 m")
    message.data = b"no picture"
    message.data_length = len(message.data)
    code, output = look(bus_url, lcmtools_path, message, *words)
    assert code == 1
    assert_line(output, "lcmtools run kinect_viewer: ", "picture", "PNG, JPEG or PGM")


def encode_png_of_depth():
    file = io.BytesIO()
    PIL.Image.frombytes("I;16", (2, 1), struct.pack("<2H", 700, 1200)).save(file, "PNG")
    return file.getvalue()


@pytest.mark.parametrize("ending", [signal.SIGINT, "q"])
def test_terminal_shows_the_picture_and_is_given_back(  # noqa: PLR0915 - one story, from begin to end
    ending, bus_url, lcmtools_path, wait_until
):
    screen, end = pty.openpty()
    ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 12, 40, 0, 0))
    before = termios.tcgetattr(end)
    written = bytearray()
    bus = lcm.LCM(bus_url)

    def shows(text):
        bus.publish(TOPIC, picture().encode())
        while select.select([screen], [], [], 0.02)[0]:
            written.extend(os.read(screen, 65536))
        return text in written

    environment = {"LCM_DEFAULT_URL": bus_url, "TERM": "xterm", "COLORTERM": "truecolor"}
    with subprocess.Popen(
        [lcmtools_path, "run", "kinect_viewer", "--terminal"],
        stdin=end, stdout=end, stderr=end, env={**os.environ, **environment},
        start_new_session=True,
    ) as viewer:  # fmt: skip
        try:
            wait_until(lambda: shows(b"near 1 m  far 1.5 m") and shows(b"8 x 6 16UC1"))
            assert b"\x1b[?25l" in written
            assert "\u2580".encode() in written
            written.clear()
            ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 90, 0, 0))
            wait_until(lambda: shows(b"\x1b[2J"))  # drawn again in the new size
            if isinstance(ending, str):
                os.write(screen, ending.encode())
            else:
                viewer.send_signal(ending)
            wait_until(lambda: shows(b"\x1b[?25h\x1b[?1049l"))
            wait_until(lambda: viewer.poll() is not None)
            assert viewer.returncode == 0
            assert termios.tcgetattr(end) == before
        finally:
            viewer.kill()
    os.close(screen)
    os.close(end)


def test_a_terminal_that_is_closed_ends_a_viewer_as_its_signal_does(
    bus_url, lcmtools_path, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    with closing(Typist(lcmtools_path, "run", "image_view", "--terminal")) as user:
        user.wait_for("\x1b[H")
        user.hang_up()
        assert user.process.wait(40) == 0


@pytest.mark.parametrize("display", ["", ":0"])
def test_a_viewer_serves_the_image_panel_and_opens_it_where_there_is_a_display(
    display, bus_url, lcmtools_path, start, tmp_path, monkeypatch
):
    opened, browser = tmp_path / "opened", tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {opened}\n')
    browser.chmod(0o755)
    environment = {"LCM_DEFAULT_URL": bus_url, "DISPLAY": display, "WAYLAND_DISPLAY": ""}
    for name, value in {**environment, "BROWSER": f"{browser} %s"}.items():
        monkeypatch.setenv(name, value)
    words = ("image_view", f"image:={TOPIC}", "--far", "4", *([] if display else ["--window"]))
    with closing(Typist(lcmtools_path, "run", *words)) as user:
        user.wait_for("; Ctrl-C ends it")
        address = user.written.decode().partition("open ")[2].split()[0]
        with LivePage(address) as page:
            settings = {"topic": TOPIC, "map": "warm", "near": 0.0, "far": 4.0}
            assert page.hello["view"] == {"panel": "image", "settings": settings}
            assert page.hello["rights"] == ["watch"]
            page.open(1, "image", topic=TOPIC)
            values = "{encoding: mono8, width: 1, height: 1, step: 1, data: [7]}"
            start(lcmtools_path, "pub", "-r", "20", TOPIC, "sensor_msgs/Image", values)
            assert page.until(lambda frame: "payload" in frame)["payload"] == b"\7"
            user.process.send_signal(signal.SIGINT)
            assert user.end() == 0
    assert opened.exists() == bool(display)
    assert not display or opened.read_text() == f"{address}\n"
