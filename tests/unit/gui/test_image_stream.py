"""The stream of an image topic."""

import struct
import time
import zlib

import pytest
from fixtures.gui import FakeSource
from fixtures.says import assert_says

from lcmtools.gui.streams.image import NewestImage
from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools.types.std_msgs import String


def _open(source, **parameters):
    source.know(camera=Image)
    return NewestImage(source, topic="/camera", **parameters)


def _image(encoding, width, height, data):
    message = Image()
    message.encoding, message.width, message.height = encoding, width, height
    message.data, message.data_length, message.step = data, len(data), len(data) // height
    return message


def _file(kind, data):
    message = CompressedImage()
    message.format, message.data, message.data_length = kind, data, len(data)
    return message


def _png(width, height, bits, color):
    header = struct.pack(">4sIIBBBBB", b"IHDR", width, height, bits, color, 0, 0, 0)
    check = struct.pack(">I", zlib.crc32(header))
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + check


def test_the_newest_image_comes_once():
    source = FakeSource()
    stream = _open(source)
    assert stream.update() is None
    source.put("/camera", _image("mono8", 2, 1, b"ab"), 1.0)
    source.put("/camera", _image("mono8", 2, 1, b"cd"), 2.0)
    update = stream.update()
    assert update.payload == b"cd"
    assert (update.data["count"], update.data["time"]) == (2, 2.0)
    assert stream.update() is None


def test_no_more_images_come_than_the_rate_allows(monkeypatch):
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    source = FakeSource()
    stream, other = _open(source, rate=2.0), _open(source)
    source.put("/camera", _image("mono8", 2, 1, b"ab"))
    assert stream.update()
    assert other.update()
    source.put("/camera", _image("mono8", 2, 1, b"cd"))
    now = 100.4
    assert stream.update() is None
    assert other.update()
    now = 100.5
    assert stream.update()


def test_depth_comes_with_its_unit_and_its_numbers():
    source = FakeSource()
    stream = _open(source)
    source.put("/camera", _image("16UC1", 2, 2, struct.pack("<4H", 0, 1, 2, 65535)))
    update = stream.update()
    assert update.payload == struct.pack("<4H", 0, 1, 2, 65535)
    expected = {"kind": "depth", "number": "H", "unit": "mm", "width": 2, "height": 2, "step": 1}
    assert {name: update.data[name] for name in expected} == expected


def test_no_more_pixels_come_than_the_page_shows():
    source = FakeSource()
    stream = _open(source, pixels=1000)
    source.put("/camera", _image("mono8", 100, 50, bytes(range(250)) * 20))
    update = stream.update()
    assert (update.data["step"], update.data["columns"], update.data["rows"]) == (3, 34, 17)
    assert (update.data["width"], update.data["height"]) == (100, 50)
    assert len(update.payload or b"") == 34 * 17


def test_large_images_come_less_often(monkeypatch):
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    source = FakeSource()
    stream = _open(source)
    large = _image("mono8", 3000, 1000, bytes(3_000_000))  # 0.1 s of 30 MB/s
    source.put("/camera", large)
    assert stream.update() is not None
    source.put("/camera", large)
    now = 100.09
    assert stream.update() is None
    now = 100.11
    assert stream.update() is not None


@pytest.mark.parametrize(
    ("data", "kind"), [(b"\xff\xd8\xff\xe0 ...", "image/jpeg"), (_png(4, 3, 8, 2), "image/png")]
)
def test_files_of_images_come_as_they_are(data, kind):
    source = FakeSource()
    stream = _open(source)
    source.put("/camera", _file("x", data))
    update = stream.update()
    assert (update.payload, update.data["file"]) == (data, kind)
    assert "kind" not in update.data


def test_a_png_file_of_16_bits_is_depth():
    source = FakeSource()
    stream = _open(source)
    data = _png(4, 3, 16, 0)
    source.put("/camera", _file("16UC1; compressedDepth png", b"twelve bytes" + data))
    update = stream.update()
    assert update.payload == data
    expected = {"kind": "depth", "unit": "mm", "width": 4, "height": 3}
    assert {name: update.data[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("message", "problem"),
    [
        (_image("mono8", 9, 1, b"ab"), "9 x 1 mono8 does not fit its data: 2 bytes in rows of 2"),
        (_image("yuv422", 1, 1, b"ab"), "pictures in 'yuv422' are not shown; known: "),
        (_file("h264", b"\0\0\0\1"), "pictures in 'h264' are not shown; known: jpeg, png"),
        (_file("png", _png(1 << 20, 1 << 20, 8, 2)), "a picture of 1048576 x 1048576 png is not"),
        (
            String(),
            "/camera has no images: its messages are std_msgs/String; images are on /camera",
        ),
    ],
)
def test_what_cannot_be_drawn_is_a_problem_until_an_image_comes(message, problem):
    source = FakeSource()
    stream = _open(source)
    source.put("/camera", message)
    assert stream.update() is None
    assert stream.problem().startswith(problem)
    source.put("/camera", _image("mono8", 1, 1, b"a"))
    assert stream.update() is not None
    assert stream.problem() == ""


def test_an_unknown_topic_is_named_with_the_near_one():
    source = FakeSource()
    source.know(camera=Image)
    stream = NewestImage(source, topic="/camra")
    assert_says(stream.problem(), "no topic /camra", "did you mean /camera?")
