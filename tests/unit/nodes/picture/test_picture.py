"""Pictures: read from messages and files, coloured, and shown in terminals and files."""

import io
import re
import struct
import sys
import zlib
from array import array

import PIL.Image
import pytest

from lcmtools.errors import DecodeError, MissingExtra, UsageError
from lcmtools.labs.nodes.picture.colors import (
    ColorOptions,
    colored,
    facts,
    mix,
    sentence,
)
from lcmtools.labs.nodes.picture.display import numbered, values_of
from lcmtools.labs.nodes.picture.screen import (
    ScreenDisplay,
    TerminalColors,
    blocks,
    terminal_colors,
)
from lcmtools.labs.nodes.picture.viewer import choose_display, panel_settings, viewer_parser
from lcmtools.messages.pictures import read_picture
from lcmtools.messages.pixels import COLOR_MAPS
from lcmtools.types.sensor_msgs import CompressedImage, Image

WARM = ColorOptions(COLOR_MAPS["warm"])
NEAREST, FARTHEST = COLOR_MAPS["warm"][0], COLOR_MAPS["warm"][-1]


def image(encoding, width, height, data, **fields):
    message = Image()
    message.encoding, message.width, message.height = encoding, width, height
    message.data, message.data_length = data, len(data)
    message.step = fields.get("step", len(data) // height)
    message.is_bigendian = fields.get("is_bigendian", 0)
    return message


def depth(width, height, *millimetres):
    return image("16UC1", width, height, struct.pack(f"<{len(millimetres)}H", *millimetres))


def compressed(data, format="png"):  # noqa: A002 - the field's name
    message = CompressedImage()
    message.data, message.data_length, message.format = data, len(data), format
    return message


def file_of(image, kind="PNG"):
    stream = io.BytesIO()
    image.save(stream, kind)
    return stream.getvalue()


def pixels(picture):
    if picture.image.mode != "RGB":
        return list(picture.values())
    data = picture.image.tobytes()
    return list(zip(data[::3], data[1::3], data[2::3], strict=True))


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
def test_pixels_are_read_by_their_encoding(message, row):
    assert pixels(read_picture(message)) == row


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
def test_picture_that_cannot_be_is_refused_with_the_reason(message, reason):
    with pytest.raises(DecodeError, match=reason):
        read_picture(message)


def test_compressed_pictures_are_read():
    depths = PIL.Image.frombytes("I;16", (2, 1), struct.pack("<2H", 700, 1200))
    assert pixels(read_picture(compressed(file_of(depths)))) == [700, 1200]
    of_ros = compressed(bytes(12) + file_of(depths), "16UC1; compressedDepth png")
    assert pixels(read_picture(of_ros)) == [700, 1200]
    red = PIL.Image.new("RGBA", (1, 1), (255, 0, 0, 7))
    assert pixels(read_picture(compressed(file_of(red)))) == [(255, 0, 0)]
    grey = PIL.Image.new("L", (8, 8), 200)
    assert set(pixels(read_picture(compressed(file_of(grey, "JPEG"), "jpeg")))) == {200}


def huge_png(size):
    header = struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(b"")), (b"IEND", b""))
    chunks = (
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in parts
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


@pytest.mark.parametrize(
    "data",
    [
        b"no picture",
        b"\xff\xd8\xff\xe0",
        file_of(PIL.Image.new("L", (9, 9)))[:40],
        file_of(PIL.Image.new("L", (9, 9))).replace(b"IDAT", b"IDAX"),
        huge_png(1 << 30),
        huge_png(10_000),
        huge_png(8_500),
    ],
)
def test_a_file_that_is_no_picture_or_too_large_is_refused(data):
    with pytest.raises(DecodeError, match=r"broken picture: |is not shown"):
        read_picture(compressed(data))


def test_depth_goes_from_light_to_dark_and_no_reading_is_black():
    view = colored(read_picture(depth(3, 1, 1000, 2000, 0)), WARM)
    assert view.image.tobytes() == bytes([*NEAREST, *FARTHEST, 0, 0, 0])
    assert view.legend_ends == ("1 m", "2 m")


def test_a_given_scale_is_kept_and_exchanged_ends_are_refused():
    view = colored(
        read_picture(depth(2, 1, 4000, 9000)), ColorOptions(COLOR_MAPS["warm"], 0.0, 4.0)
    )
    assert view.image.tobytes() == bytes(FARTHEST * 2)
    with pytest.raises(UsageError, match="--near 2 is not below --far 1"):
        ColorOptions(COLOR_MAPS["warm"], 2.0, 1.0)


def test_grey_of_16_bits_is_stretched_and_of_8_bits_is_not():
    of_16 = read_picture(image("mono16", 2, 1, struct.pack("<2H", 1000, 1100)))
    assert colored(of_16, WARM).image.tobytes() == bytes([0, 0, 0, 255, 255, 255])
    of_8 = read_picture(image("mono8", 2, 1, bytes([10, 20])))
    assert colored(of_8, WARM).image.tobytes() == bytes([10, 10, 10, 20, 20, 20])


def test_middle_of_a_color_map_lies_between_its_colors():
    assert mix(((0, 0, 0), (100, 200, 50)), 0.5) == (50, 100, 25)
    assert mix(((0, 0, 0), (100, 200, 50)), 1.0) == (100, 200, 50)


@pytest.mark.parametrize(
    ("room", "size"), [((100, 76), (100, 75)), ((1000, 48), (64, 48)), ((1, 1), (1, 1))]
)
def test_picture_keeps_its_proportions(room, size):
    picture = read_picture(image("mono8", 640, 480, bytes(640 * 480)))
    assert picture.fitted(*room).image.size == size


@pytest.mark.parametrize(
    ("environment", "wants_color", "colors"),
    [
        ({"COLORTERM": "truecolor"}, True, TerminalColors.FULL),
        ({"COLORTERM": "24bit"}, True, TerminalColors.FULL),
        ({"TERM": "xterm-256color"}, True, TerminalColors.INDEXED),
        ({"COLORTERM": "truecolor"}, False, TerminalColors.NONE),
    ],
)
def test_colors_are_those_of_the_terminal(
    environment,
    wants_color,
    colors,
):
    assert terminal_colors(environment, wants_color=wants_color) is colors


# two columns of three rows: red, white; red, white; (8, 8, 9), blue
SIX_PIXELS = PIL.Image.frombytes(
    "RGB", (2, 3), bytes([255, 0, 0, 255, 255, 255] * 2 + [8, 8, 9, 0, 0, 255])
)


@pytest.mark.parametrize(
    ("colors", "lines"),
    [
        (
            TerminalColors.FULL,
            [
                "\x1b[38;2;255;0;0;48;2;255;0;0m▀\x1b[38;2;255;255;255;48;2;255;255;255m▀\x1b[0m",
                "\x1b[38;2;8;8;9;48;2;0;0;0m▀\x1b[38;2;0;0;255;48;2;0;0;0m▀\x1b[0m",
            ],
        ),
        (
            TerminalColors.INDEXED,
            [
                "\x1b[38;5;196;48;5;196m▀\x1b[38;5;231;48;5;231m▀\x1b[0m",
                "\x1b[38;5;232;48;5;16m▀\x1b[38;5;21;48;5;16m▀\x1b[0m",
            ],
        ),
        (TerminalColors.NONE, ["░█", "  "]),
    ],
)
def test_a_character_has_the_colors_of_two_pixels(colors, lines):
    assert blocks(SIX_PIXELS, colors) == lines


def test_a_color_is_written_once_for_a_row_of_equal_pixels():
    (line,) = blocks(PIL.Image.new("RGB", (50, 2)), TerminalColors.FULL)
    assert line == f"\x1b[38;2;0;0;0;48;2;0;0;0m{'▀' * 50}\x1b[0m"


@pytest.mark.parametrize("columns", [1, 20, 64, 80])
def test_no_line_is_longer_than_the_terminal_is_wide(columns, monkeypatch, capsys):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setenv("LINES", "20")
    display = ScreenDisplay(WARM, is_single=True)
    display.show(read_picture(depth(2, 1, 1000, 2000)))
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) <= 20
    assert max(len(re.sub(r"\x1b\[[0-9;]*[mK]", "", row)) for row in rows) <= columns
    # a clear at the end of a full line would take its last character
    assert rows[0].endswith("\x1b[K") == (columns > 72)
    assert any("near 1 m" in row for row in rows) == (columns > 1)
    assert any("2 x 1 16UC1" in row for row in rows) == (columns > 1)


@pytest.mark.parametrize(
    ("words", "display", "environment"),
    [
        ("", "BrowserDisplay", {"DISPLAY": ":0"}),
        ("", "BrowserDisplay", {"WAYLAND_DISPLAY": "wayland-0"}),
        ("", "ScreenDisplay", {}),
        ("--terminal", "ScreenDisplay", {"DISPLAY": ":0"}),
        ("--once", "ScreenDisplay", {"DISPLAY": ":0"}),
        ("--json", "LineDisplay", {"DISPLAY": ":0"}),
        ("--save a.png", "LineDisplay", {"DISPLAY": ":0"}),
        ("", "LineDisplay", {"DISPLAY": ":0", "TERM": "dumb"}),
        ("--window", "BrowserDisplay", {}),
        ("--window", "BrowserDisplay", {"TERM": "dumb"}),
    ],
)
def test_pictures_are_shown_where_they_can_be_seen(words, display, environment, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    for name, value in (
        {"DISPLAY": "", "WAYLAND_DISPLAY": "", "TERM": "xterm"} | environment
    ).items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert type(choose_display(viewer_parser().parse_args(words.split()))).__name__ == display


@pytest.mark.parametrize(
    ("words", "display", "told"),
    [("", "", True), ("--once", "", False), ("--terminal", ":0", False)],
)
def test_a_terminal_without_a_display_tells_of_the_browser(
    words,
    display,
    told,
    monkeypatch,
    capsys,
):
    monkeypatch.setattr(sys, "platform", "linux")
    for name, value in {"DISPLAY": display, "TERM": "xterm", "COLUMNS": "100"}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    shown = choose_display(viewer_parser().parse_args(words.split()))
    shown.show(read_picture(depth(2, 1, 1000, 2000)))
    assert ("2 x 1 16UC1  in a browser: --window" in capsys.readouterr().out) == told


@pytest.mark.parametrize(
    ("words", "settings"),
    [
        ("", {"map": "warm"}),
        ("--colors grey --rate 5", {"map": "grey", "rate": 5.0}),
        ("--near 1 --far 2", {"map": "warm", "near": 1.0, "far": 2.0}),
        ("--far 2", {"map": "warm", "near": 0.0, "far": 2.0}),
    ],
)
def test_the_panel_has_the_settings_of_the_command_line(words, settings):
    options = viewer_parser().parse_args(["--window", *words.split()])
    assert panel_settings(options) == settings


def test_without_the_extra_a_line_says_so_and_the_terminal_is_used(monkeypatch, capsys):
    for name, value in {"DISPLAY": ":0", "TERM": "xterm"}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.delitem(sys.modules, "lcmtools.gui.server", raising=False)
    monkeypatch.delitem(sys.modules, "lcmtools.labs.nodes.picture.browser", raising=False)
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    assert isinstance(choose_display(viewer_parser().parse_args([])), ScreenDisplay)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("pictures in the browser need the extra 'web' (")
    assert line.endswith("'lcmtools-robotics[web]'; shown in the terminal")
    with pytest.raises(MissingExtra):
        choose_display(viewer_parser().parse_args(["--window"]))


def test_picture_is_described_in_words():
    known = facts(read_picture(depth(3, 1, 620, 0, 4310)))
    assert sentence(known) == "3 x 1 16UC1  min 0.62 m  max 4.31 m  middle none"
    assert sentence(facts(read_picture(image("rgb8", 1, 1, b"abc")))) == "1 x 1 rgb8"
    nothing = facts(read_picture(depth(1, 1, 0)))
    assert sentence(nothing) == "1 x 1 16UC1  min none  max none  middle none"


def test_files_are_numbered_and_have_values():
    assert [numbered("a%04d.png", 7), numbered("a%d%s", 7), numbered("a", 7)] == [
        "a0007.png", "a7%s", "a",
    ]  # fmt: skip
    values = values_of(read_picture(depth(2, 1, 1000, 65535)))
    assert read_picture(compressed(file_of(values))).values() == [1000, 65535]
