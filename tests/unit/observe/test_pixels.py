"""The pixels in messages of images."""

import struct

import pytest

from lcmtools.errors import DecodeError
from lcmtools.messages.pixels import Kind, PixelFormat, Pixels, as_file, image_file, read_pixels
from lcmtools.types.sensor_msgs import CompressedImage, Image


def image(encoding, width, height, data, **fields):
    message = Image()
    message.encoding, message.width, message.height = encoding, width, height
    message.data, message.data_length = data, len(data)
    message.step = fields.get("step", len(data) // max(1, height))
    message.is_bigendian = fields.get("is_bigendian", 0)
    return message


def test_rows_come_without_what_is_behind_them():
    pixels = read_pixels(image("16UC1", 1, 2, b"ab--cd", step=4))  # the last row may be short
    assert pixels == Pixels(1, 2, PixelFormat(Kind.DEPTH, "H"), b"abcd")
    assert pixels.format.unit == "mm"


def test_numbers_come_with_the_least_significant_byte_first():
    pixels = read_pixels(image("32FC1", 1, 1, struct.pack(">f", 1.5), is_bigendian=1))
    assert struct.unpack("<f", pixels.data) == (1.5,)
    assert pixels.format.unit == "m"


@pytest.mark.parametrize(
    ("encoding", "code", "numbers", "metres"),
    [("16SC1", "h", (-250, 1500), (-0.25, 1.5)), ("64FC1", "d", (-0.25, 1.5), (-0.25, 1.5))],
)
@pytest.mark.parametrize("order", "<>")
def test_wider_numbers_become_metres(encoding, code, numbers, metres, order):
    data = struct.pack(f"{order}2{code}", *numbers)
    pixels = read_pixels(image(encoding, 2, 1, data, is_bigendian=int(order == ">")))
    assert pixels.format == PixelFormat(Kind.DEPTH, "f")
    assert struct.unpack("<2f", pixels.data) == metres


@pytest.mark.parametrize("encoding", ["jpeg", "JPEG", "jpg", "png"])
def test_an_image_may_hold_a_file(encoding):
    file = as_file(image(encoding, 2, 1, b"a file"))
    assert (bytes(file.data), file.format) == (b"a file", encoding)
    assert as_file(image("mono8", 1, 1, b"a")) is None


def test_a_mosaic_of_colours_counts_as_grey():
    assert read_pixels(image("bayer_rggb8", 2, 1, b"ab")).format == PixelFormat(Kind.GREY)
    assert read_pixels(image("bayer_gbrg16", 1, 1, b"ab")).format == PixelFormat(Kind.GREY, "H")


@pytest.mark.parametrize(
    ("encoding", "size"), [("mono8", 1), ("mono16", 2), ("rgb8", 3), ("rgba8", 4)]
)
@pytest.mark.parametrize(("width", "height", "step"), [(5, 4, 2), (6, 3, 3), (2, 2, 4), (3, 3, 1)])
def test_every_nth_pixel_of_every_nth_row(encoding, size, width, height, step):
    data = bytes(n % 251 for n in range(width * height * size))
    pixels = read_pixels(image(encoding, width, height, data)).every(step)
    expected = [
        data[(y * width + x) * size : (y * width + x + 1) * size]
        for y in range(0, height, step)
        for x in range(0, width, step)
    ]
    assert pixels.data == b"".join(expected)
    assert (pixels.width, pixels.height) == (-(-width // step), -(-height // step))


@pytest.mark.parametrize(
    ("message", "what"),
    [
        (image("yuv422", 2, 1, b"abcd"), "pictures in 'yuv422' are not shown"),
        (image("rgb8", 2, 2, b"abcdef"), "2 x 2 rgb8 does not fit its data: 6 bytes in rows of 3"),
        (image("mono8", 2, 2, b"abc"), "2 x 2 mono8 does not fit its data: 3 bytes in rows of 1"),
        (image("mono8", -1, 2, b"ab"), "a picture of -1 x 2 mono8 is not shown"),
        (image("mono8", 1 << 20, 1 << 20, b""), "a picture of 1048576 x 1048576 mono8"),
    ],
)
def test_images_with_wrong_sizes_are_refused(message, what):
    with pytest.raises(DecodeError) as error:
        read_pixels(message)
    assert str(error.value).startswith(what)


def test_an_image_file_comes_without_the_header_of_compressed_depth():
    message = CompressedImage()
    message.data, message.format = b"twelve bytes\x89PNG", "16UC1; compressedDepth png"
    assert image_file(message) == b"\x89PNG"
    message.format = "png"
    assert image_file(message) == b"twelve bytes\x89PNG"
