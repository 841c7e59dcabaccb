"""Pictures: read from messages and PNG files, coloured, and written for terminals and files."""

import base64
import random
import re
import struct
import zlib
from array import array

import pytest

from lcmtools.errors import DecodeError
from lcmtools.labs.nodes.picture.blocks import (
    Depth,
    color_depth,
    draw_blocks,
    draw_legend,
    nearest_256,
)
from lcmtools.labs.nodes.picture.display import colors_of, numbered, values_of
from lcmtools.labs.nodes.picture.graphics import graphics_in
from lcmtools.labs.nodes.picture.kitty import draw_kitty
from lcmtools.labs.nodes.picture.pixels import read_picture
from lcmtools.labs.nodes.picture.png import PngPixels, decode_png, encode_png
from lcmtools.labs.nodes.picture.sample import Look, fitting_size, take_view
from lcmtools.labs.nodes.picture.shades import COLOR_MAPS, mix
from lcmtools.labs.nodes.picture.sixel import draw_sixel
from lcmtools.labs.nodes.picture.words import facts, sentence
from lcmtools.types.sensor_msgs import CompressedImage, Image

WARM = Look(COLOR_MAPS["warm"])
NEAREST, FARTHEST = COLOR_MAPS["warm"][0], COLOR_MAPS["warm"][-1]


def image(encoding: str, width: int, height: int, data: bytes, **fields: int) -> Image:
    message = Image()
    message.encoding, message.width, message.height = encoding, width, height
    message.data, message.data_length = data, len(data)
    message.step = fields.get("step", len(data) // height)
    message.is_bigendian = fields.get("is_bigendian", 0)
    return message


def depth(width: int, height: int, *millimetres: int) -> Image:
    return image("16UC1", width, height, struct.pack(f"<{len(millimetres)}H", *millimetres))


def png(channels: int, bits: int, filters: list[int], rows: list[bytes]) -> bytes:
    """A PNG file with a filter of our choice for each row, by the standard's definition."""
    pixel = channels * bits // 8
    above = bytes(len(rows[0]))
    content = b""
    for kind, row in zip(filters, rows, strict=True):
        coded = bytearray()
        for at, value in enumerate(row):
            a = row[at - pixel] if at >= pixel else 0
            b = above[at]
            c = above[at - pixel] if at >= pixel else 0
            p = a + b - c
            paeth = min((a, b, c), key=lambda one, p=p: abs(p - one))
            guesses = {0: 0, 1: a, 2: b, 3: (a + b) // 2, 4: paeth}
            coded.append((value - guesses.get(kind, 0)) % 256)
        content += bytes([kind]) + coded
        above = row
    color = {1: 0, 3: 2, 4: 6}[channels]
    width = len(rows[0]) // pixel
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", width, len(rows), bits, color, 0, 0, 0)),
        (b"IDAT", zlib.compress(content)),
        (b"IEND", b""),
    ]
    packed = b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + packed


@pytest.mark.parametrize(("channels", "bits"), [(1, 8), (1, 16), (3, 8), (4, 8)])
def test_png_of_every_filter_is_read(channels: int, bits: int) -> None:
    source = random.Random(channels)  # noqa: S311 - any numbers
    rows = [source.randbytes(7 * channels * bits // 8) for _ in range(10)]
    decoded = decode_png(png(channels, bits, [0, 1, 2, 3, 4, 4, 3, 2, 1, 0], rows))
    assert decoded == PngPixels(7, 10, channels, bits, b"".join(rows))
    assert decode_png(encode_png(decoded)) == decoded


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda data: data[:20], "requires a buffer"),
        (lambda data: b"GIF" + data, "no PNG signature"),
        (lambda data: data.replace(b"IDAT", b"IDAX"), "checksum"),
        (lambda _: png(1, 8, [7], [b"abc"]), "unknown filter 7"),
    ],
)
def test_broken_png_is_refused_with_the_reason(change: object, reason: str) -> None:
    good = png(1, 8, [0], [b"abc"])
    with pytest.raises(DecodeError, match=rf"broken PNG picture: .*{reason}"):
        decode_png(change(good))  # type: ignore[operator]


def test_png_that_says_it_is_huge_costs_no_memory() -> None:
    header = struct.pack(">IIBBBBB", 1 << 30, 1 << 30, 8, 0, 0, 0, 0)
    chunk = (
        struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(b"IHDR" + header))
    )
    end = struct.pack(">I", 0) + b"IEND" + struct.pack(">I", zlib.crc32(b"IEND"))
    with pytest.raises(DecodeError, match="1073741824 x 1073741824 pixels"):
        decode_png(b"\x89PNG\r\n\x1a\n" + chunk + end)


@pytest.mark.parametrize(
    ("message", "row"),
    [
        (depth(3, 1, 0, 500, 65535), [0, 500, 65535]),
        (image("16UC1", 2, 1, b"\1\0\0\2", is_bigendian=1), [256, 2]),
        (
            image("32FC1", 4, 1, array("f", [0.5, float("nan"), float("inf"), -1.0]).tobytes()),
            [500, 0, 0, 0],
        ),
        (image("mono8", 2, 1, b"\0\xff"), [0, 255]),
        (image("rgb8", 2, 1, b"abcdef"), [(97, 98, 99), (100, 101, 102)]),
        (image("bgr8", 1, 1, b"abc"), [(99, 98, 97)]),
        (image("bgra8", 1, 1, b"abcd"), [(99, 98, 97)]),
        (image("mono8", 2, 1, b"ab--", step=4), [97, 98]),
    ],
)
def test_pixels_are_read_by_their_encoding(message: Image, row: list[object]) -> None:
    picture = read_picture(message)
    assert picture.row(0) == row
    assert picture.row(0, [len(row) - 1]) == row[-1:]


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (image("yuv422", 1, 1, b"ab"), "pictures in 'yuv422' are not shown"),
        (image("mono8", 2, 2, b"abc", step=2), "does not fit its data: 3 bytes in rows of 2"),
        (image("rgb8", 2, 1, b"abcdef", step=5), "does not fit its data"),
        (image("mono8", 0, 1, b""), "a picture of 0 x 1 mono8 is not shown"),
        (image("mono8", 1 << 20, 1 << 20, b"ab", step=1 << 20), "is not shown"),
    ],
)
def test_picture_that_cannot_be_is_refused_with_the_reason(message: Image, reason: str) -> None:
    with pytest.raises(DecodeError, match=reason):
        read_picture(message)


def test_compressed_depth_is_read_and_jpeg_refused() -> None:
    message = CompressedImage()
    message.data = encode_png(PngPixels(2, 1, 1, 16, struct.pack(">2H", 700, 1200)))
    assert read_picture(message).row(0) == [700, 1200]
    message.format, message.data = "16UC1; compressedDepth png", bytes(12) + message.data
    assert read_picture(message).row(0) == [700, 1200]
    message.format, message.data = "jpeg", b"\xff\xd8\xff\xe0"
    with pytest.raises(DecodeError, match="JPEG pictures are not shown"):
        read_picture(message)


def test_depth_goes_from_light_to_dark_and_no_reading_is_black() -> None:
    view = take_view(read_picture(depth(3, 1, 1000, 2000, 0)), WARM, 3, 1)
    assert view.rows == [[NEAREST, FARTHEST, (0, 0, 0)]]
    assert (view.scale.near, view.scale.far) == (1000, 2000)
    assert re.sub(r"\x1b\[[0-9;]*m", "", draw_legend(view, Depth.FULL)).split() == [
        "near", "1", "m", "\u2580" * 24, "2", "m", "far",
    ]  # fmt: skip


def test_scale_that_is_said_is_kept() -> None:
    look = Look(COLOR_MAPS["warm"], 0.0, 4.0)
    view = take_view(read_picture(depth(2, 1, 4000, 9000)), look, 2, 1)
    assert view.rows == [[FARTHEST, FARTHEST]]


def test_middle_of_a_color_map_lies_between_its_colors() -> None:
    assert mix(((0, 0, 0), (100, 200, 50)), 0.5) == (50, 100, 25)
    assert mix(((0, 0, 0), (100, 200, 50)), 1.0) == (100, 200, 50)


@pytest.mark.parametrize(
    ("room", "size"), [((100, 76), (100, 75)), ((1000, 48), (64, 48)), ((1, 1), (1, 1))]
)
def test_picture_keeps_its_proportions(room: tuple[int, int], size: tuple[int, int]) -> None:
    picture = read_picture(image("mono8", 640, 480, bytes(640 * 480)))
    assert fitting_size(picture, *room) == size


def test_half_blocks_show_two_rows_in_a_line() -> None:
    picture = read_picture(image("rgb8", 1, 3, bytes(range(9))))
    lines = draw_blocks(take_view(picture, WARM, 1, 3), Depth.FULL)
    assert lines == [
        "\x1b[38;2;0;1;2;48;2;3;4;5m\u2580\x1b[0m",
        "\x1b[38;2;6;7;8;48;2;6;7;8m\u2580\x1b[0m",
    ]
    few = draw_blocks(take_view(picture, WARM, 1, 3), Depth.COLORS_256)
    assert few[0] == "\x1b[38;5;16;48;5;16m\u2580\x1b[0m"
    grey = read_picture(image("mono8", 2, 2, b"\0\xff\0\xff"))
    assert draw_blocks(take_view(grey, WARM, 2, 2), Depth.NONE) == [" @"]


@pytest.mark.parametrize(
    ("color", "number"),
    [((0, 0, 0), 16), ((255, 255, 255), 231), ((255, 0, 0), 196), ((128, 128, 128), 244)],
)
def test_nearest_of_256_colors_is_found(color: tuple[int, int, int], number: int) -> None:
    assert nearest_256(color) == number


def test_colors_are_as_many_as_the_terminal_says() -> None:
    assert color_depth({"COLORTERM": "truecolor"}, wanted=True) is Depth.FULL
    assert color_depth({}, wanted=True) is Depth.COLORS_256
    assert color_depth({"COLORTERM": "truecolor"}, wanted=False) is Depth.NONE


@pytest.mark.parametrize(
    ("answer", "graphics"),
    [
        (b"\x1b_Gi=31;OK\x1b\\\x1b[?62;4c", "kitty"),
        (b"\x1b[?62;4;22c", "sixel"),
        (b"\x1b[?64;14;22c", "blocks"),
        (b"", "blocks"),
    ],
)
def test_graphics_are_what_the_terminal_answers(answer: bytes, graphics: str) -> None:
    assert graphics_in(answer) == graphics


def test_kitty_gets_the_pixels_compressed() -> None:
    picture = read_picture(image("rgb8", 2, 1, b"abcdef"))
    text = draw_kitty(take_view(picture, WARM, 2, 1), 10, 5)
    head, _, rest = text.partition(";")
    assert {"a=T", "f=24", "s=2", "v=1", "c=10", "r=5", "m=0"} <= set(head[3:].split(","))
    assert zlib.decompress(base64.b64decode(rest.removesuffix("\x1b\\"))) == b"abcdef"


def test_sixels_are_columns_of_six_pixels() -> None:
    picture = read_picture(image("rgb8", 4, 2, b"\0\0\0" * 4 + b"\xff\xff\xff" * 4))
    text = draw_sixel(take_view(picture, WARM, 4, 2))
    assert text == '\x1bP0;1q"1;1;4;2#0;2;0;0;0#1;2;100;100;100#0!4@$#1!4A\x1b\\'


def test_picture_is_told_in_words() -> None:
    known = facts(read_picture(depth(3, 1, 620, 0, 4310)))
    assert sentence(known) == "3 x 1 16UC1  min 0.62 m  max 4.31 m  middle none"
    assert sentence(facts(read_picture(image("rgb8", 1, 1, b"abc")))) == "1 x 1 rgb8"


def test_files_are_numbered_and_have_colors_or_values() -> None:
    assert [numbered("a%04d.png", 7), numbered("a%d%s", 7), numbered("a", 7)] == [
        "a0007.png", "a7%s", "a",
    ]  # fmt: skip
    picture = read_picture(depth(2, 1, 1000, 2000))
    assert colors_of(picture, WARM).rows == bytes([*NEAREST, *FARTHEST])
    assert values_of(picture) == PngPixels(2, 1, 1, 16, struct.pack(">2H", 1000, 2000))
    assert values_of(read_picture(image("rgb8", 1, 1, b"abc"))) is None
