"""The images of a log as files."""

from io import BytesIO
from pathlib import Path

import PIL.Image
import pytest
from fixtures.says import assert_says

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.packet import Packet

_S = 10**9
_START = 1_795_384_180 * _S


def _image(encoding, data, size):
    return Image(width=2, height=1, step=2 * size, encoding=encoding, data=data)


def _file(form):
    made = BytesIO()
    PIL.Image.new("RGB", (2, 1), (250, 10, 10)).save(made, form)
    return made.getvalue()


@pytest.fixture(autouse=True)
def _log(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    color = _image("bgr8", bytes((0, 0, 255, 0, 255, 0)), 3)
    color.header.stamp.sec, color.header.stamp.nsec = 12, 5
    depth = _image("32FC1", b"\0\0\x80\x3f" + b"\0\0\xc0\x7f", 4)  # 1 m, and none
    messages = [
        *(("/camera/image", one) for one in (color, color)),
        ("/camera/depth", depth),
        ("/camera/png", CompressedImage(format="png", data=_file("PNG"))),
        ("/camera/jpeg", CompressedImage(format="jpeg", data=_file("JPEG"))),
        ("/speed", Float64()),
    ]
    with LogWriter("in.lcmlog") as log:
        for number, (topic, message) in enumerate(messages):
            log.add(Packet(topic, encode(message), _START + number))


def _files():
    found = {}
    for path in Path("out").rglob("*.*"):
        with PIL.Image.open(path) as image:
            image.load()
            found[str(path.relative_to("out"))] = image
    return found


def test_each_image_is_a_png_file(capsys):
    assert main(["bag", "export", "in.lcmlog", "out", "--format", "png"]) == 1
    said = capsys.readouterr()
    assert_says(said.err, "messages on /speed are left out: std_msgs/Float64 is no image")
    assert_says(said.out, "out: 5 messages")
    found = _files()
    assert sorted(found) == [
        "camera_depth/1795384180.000000000.png",
        "camera_image/12.000000005.png",
        "camera_image/12.000000005_2.png",
        "camera_jpeg/1795384180.000000000.png",
        "camera_png/1795384180.000000000.png",
    ]
    color = found["camera_image/12.000000005.png"]
    assert color.tobytes() == bytes((255, 0, 0, 0, 255, 0))
    depth = found["camera_depth/1795384180.000000000.png"]
    assert [depth.getpixel((x, 0)) for x in (0, 1)] == [1000, 0]
    copied = Path("out/camera_png/1795384180.000000000.png").read_bytes()
    assert copied == _file("PNG")


def test_each_image_is_a_jpeg_file(capsys):
    assert main(["bag", "export", "in.lcmlog", "out", "--format", "jpeg", "-t", "/camera"]) == 1
    assert_says(capsys.readouterr().err, "/camera/depth are left out: depth cannot be in a JPEG")
    assert len(_files()) == 4
    copied = Path("out/camera_jpeg/1795384180.000000000.jpg").read_bytes()
    assert copied == _file("JPEG")


def test_pictures_are_files_in_a_folder(capsys):
    assert main(["bag", "export", "in.lcmlog", "-", "--format", "png"]) == 2
    assert_says(capsys.readouterr().err, "what has a file for each image is a folder")
