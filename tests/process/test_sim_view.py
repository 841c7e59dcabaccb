"""The simulator's window is a process of its own, which ends with the simulator; labs open it."""

import signal
import socket
import urllib.request
from contextlib import suppress
from urllib.error import URLError
from urllib.parse import urlsplit

import pytest
from fixtures.programs import PYTHON_SCRIPT

pytest.importorskip("pybullet")
pytest.importorskip("websockets")
pytestmark = pytest.mark.usefixtures("quiet_network")  # of its usual port


def is_there(address):
    """Return if a page is served."""
    with suppress(URLError, OSError), urllib.request.urlopen(address) as answer:  # noqa: S310
        return b"<title>lcmtools</title>" in answer.read()
    return False


@pytest.mark.parametrize(("word", "number"), [("--view", signal.SIGKILL), ("--gui", signal.SIGINT)])
def test_the_window_is_opened_and_ends_with_the_simulator(
    start, lcmtools_path, bus_url, wait_until, word, number
):
    simulator = start(lcmtools_path, "run", "sim", word, "--lcm-url", bus_url)
    address = simulator.wait_for("http://").split()[-1]
    assert is_there(address)

    simulator.send_signal(number)

    simulator.wait()
    wait_until(lambda: not is_there(address))


def test_a_second_window_takes_the_next_free_port(start, lcmtools_path, bus_url):
    words = ("run", "sim", "empty", "--view", "--lcm-url", bus_url)
    first = start(lcmtools_path, *words).wait_for("open http://")
    second = start(lcmtools_path, *words, "__name:=other").wait_for("open http://")

    assert first != second
    assert is_there(second.split()[1])


@pytest.fixture
def browser(tmp_path):
    """A program that reads the page that it is asked to open, notes it, and ends with it."""
    program = tmp_path / "browser"
    program.write_text(
        f"{PYTHON_SCRIPT}\n"
        "import contextlib, pathlib, sys, time, urllib.request\n"
        "read = lambda: urllib.request.urlopen(sys.argv[1], timeout=20).read()\n"
        "read()\n"
        f"file = pathlib.Path({str(tmp_path)!r}, 'opening')\n"
        "file.write_text(sys.argv[1])\n"
        "file.rename(file.with_name('opened'))\n"
        "with contextlib.suppress(OSError):\n"
        "    while read():\n"
        "        time.sleep(0.1)\n"
    )
    program.chmod(0o755)
    return program


def test_lab_start_opens_the_world_where_there_is_a_display(
    start, lcmtools_path, bus_url, browser, wait_until
):
    words = ("lab", "start", "dolly", "--lcm-url", bus_url)
    lab = start(lcmtools_path, *words, DISPLAY=":0", BROWSER=f"{browser} %s")
    address = lab.wait_for("open http://").split()[1]

    wait_until(browser.with_name("opened").exists)
    assert browser.with_name("opened").read_text() == address
    assert "ssh" not in lab.wait_for("Ctrl-C ends it")
    lab.send_signal(signal.SIGINT)
    assert lab.wait() == 0
    wait_until(lambda: not is_there(address))


def test_lab_start_says_how_to_open_the_world_where_there_is_no_display(
    start, lcmtools_path, bus_url
):
    lab = start(lcmtools_path, "lab", "start", "dolly", "--lcm-url", bus_url)
    address = lab.wait_for("open http://").split()[1]
    port = urlsplit(address).port
    assert f"ssh -L {port}:localhost:{port} {socket.gethostname()}" in lab.wait_for("another comp")
    assert is_there(address)


def test_lab_start_can_leave_the_world_closed(start, lcmtools_path, bus_url):
    words = ("lab", "start", "dolly", "--no-view", "--duration", "1", "--lcm-url", bus_url)
    lab = start(lcmtools_path, *words)
    assert lab.wait() == 0
    assert "simulating dolly" in lab.output
    assert "http://" not in lab.output


def test_without_the_extra_a_line_says_so_and_the_lab_goes_on(
    start, lcmtools_path, bus_url, tmp_path, wait_until
):
    (tmp_path / "websockets.py").write_text("raise ImportError('it is not installed')\n")
    words = ("lab", "start", "dolly", "--lcm-url", bus_url)
    lab = start(lcmtools_path, *words, PYTHONPATH=str(tmp_path))
    line = lab.wait_for("the extra 'web'")
    assert line.startswith("lcmtools gui world: ")
    assert "pip install 'lcmtools-robotics[web]'" in line
    wait_until(lambda: "simulating dolly" in lab.output)
    lab.send_signal(signal.SIGINT)
    assert lab.wait() == 0
