"""Images show the pixels of the messages, with the depth under the pointer."""

import json
import re
import struct
import time
import zlib
from array import array
from contextlib import closing
from urllib.parse import quote

import pytest

from lcmtools import Node
from lcmtools.observe.reading.received import messages
from lcmtools.types.sensor_msgs import CompressedImage, Image
from tests.gui.conftest import panel_address

_MANY = 8  # images
_IN_TRANSIT = 2  # images: one that is to be drawn, and one that was sent before
_DEPTH = "/camera/depth/image_raw"


@pytest.fixture
def node(module_start_node):
    """A node that publishes."""
    found = module_start_node(lambda: Node("camera")).node
    return found


def _image(encoding, width, height, data):
    message = Image()
    message.encoding, message.width, message.height = encoding, width, height
    message.data, message.data_length, message.step = data, len(data), len(data) // height
    return message


def _png_of_depth(width, height, values):
    """A PNG file of 16-bit grey whose rows have the filters that there are, in turn."""
    rows, above = b"", bytes(2 * width)
    for y in range(height):
        row = struct.pack(f">{width}H", *values[y * width : (y + 1) * width])
        left = b"\0\0" + row[:-2]
        corner = b"\0\0" + above[:-2]
        kind = y % 5
        predictions = [
            bytes(len(row)), left, above,
            bytes((a + b) >> 1 for a, b in zip(left, above, strict=True)),
            bytes(map(_paeth, left, above, corner)),
        ][kind]  # fmt: skip
        rows += bytes([kind, *((a - b) % 256 for a, b in zip(row, predictions, strict=True))])
        above = row
    message = CompressedImage()
    message.format = "16UC1; png compressed"
    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    parts = [(b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    message.data = b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in parts
    )
    message.data_length = len(message.data)
    return message


def _paeth(left, above, corner):
    estimate = left + above - corner
    return min((left, above, corner), key=lambda one: abs(estimate - one))


def _show(page, node, topic, message):
    """Publish a message, again and again, until the page has an image."""
    publisher = node.create_publisher(type(message), topic)
    while not page.locator(".image-status", has_text=" \N{MULTIPLICATION SIGN} ").count():
        publisher.publish(message)
        page.wait_for_timeout(50)


def _point(page, x, y, width, height):
    """Point at the middle of a pixel of an image that is fitted; return what the page says.

    A notice above the image moves it, when the topic falls silent for example: it is aimed anew.
    """
    reading = page.locator(".reading-at", has_text=f"({x}, {y})")
    deadline = time.monotonic() + 40
    while not reading.count():
        assert time.monotonic() < deadline, page.locator(".reading-at").inner_text()
        box = page.locator(".viewport canvas").bounding_box()
        scale = min(box["width"] / width, box["height"] / height)
        left = box["x"] + (box["width"] - width * scale) / 2
        top = box["y"] + (box["height"] - height * scale) / 2
        page.mouse.move(left + (x + 0.5) * scale, top + (y + 0.5) * scale)
        page.wait_for_timeout(50)
    return str(reading.inner_text())


def test_the_depth_under_the_pointer_is_that_of_the_message(
    serve, page, module_start, lcmtools_path, module_bus_url
):
    simulator = module_start(lcmtools_path, "run", "sim", "pioneer")
    simulator.wait_for("simulating")
    page.goto(serve("image", _DEPTH)[1])
    page.get_by_text("640 \N{MULTIPLICATION SIGN} 480").wait_for()
    with closing(messages(_DEPTH, url=module_bus_url, timeout=40)) as arrivals:
        message = next(arrivals).message
    assert isinstance(message, Image)
    simulator.end()  # thirty images a second leave a page on a busy computer no time for the rest
    depths = array("H", bytes(message.data))
    for x, y in ((320, 400), (17, 460), (600, 240)):
        depth = depths[y * 640 + x] / 1000
        said = _point(page, x, y, 640, 480)
        assert said == f"({x}, {y})  {depth:.3f} m"
    page.keyboard.press("Tab")  # into the page
    page.locator(".viewport canvas").focus()
    page.keyboard.press("ArrowDown")
    assert page.locator(".reading-at").inner_text().startswith("(600, 241)")


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (_image("32FC1", 2, 2, struct.pack("<4f", 0.25, 1.5, float("nan"), 3.0)),
         ["0.250 m", "1.500 m", "no value", "3.000 m"]),
        (_image("16UC1", 2, 2, struct.pack("<4H", 0, 1234, 65535, 1)),
         ["no value", "1.234 m", "65.535 m", "0.001 m"]),
        (_image("mono8", 2, 2, b"\0\x10\x80\xff"), ["0", "16", "128", "255"]),
        (_image("mono16", 2, 2, struct.pack("<4H", 0, 1234, 65535, 1)),
         ["0", "1234", "65535", "1"]),
        (_image("rgb8", 2, 2, bytes(range(12))),
         ["R 0  G 1  B 2", "R 3  G 4  B 5", "R 6  G 7  B 8", "R 9  G 10  B 11"]),
        (_image("bgra8", 2, 2, bytes(range(16))),
         ["R 2  G 1  B 0", "R 6  G 5  B 4", "R 10  G 9  B 8", "R 14  G 13  B 12"]),
        (_image("bayer_rggb8", 2, 2, b"\1\2\3\4"), ["1", "2", "3", "4"]),
    ],
    ids=lambda one: one.encoding if isinstance(one, Image) else "",
)  # fmt: skip
def test_the_pixels_are_those_of_the_message(serve, page, node, message, expected):
    topic = f"/images/{message.encoding.lower()}"
    page.goto(serve("image", topic)[1])
    _show(page, node, topic, message)
    places = ((0, 0), (1, 0), (0, 1), (1, 1))
    assert [_point(page, *place, 2, 2).partition(")  ")[2] for place in places] == expected


def test_compressed_depth_keeps_its_sixteen_bits(serve, page, node):
    values = [(n * 7919 + 1) % 65536 for n in range(7 * 11)]
    page.goto(serve("image", "/depth_png")[1])
    _show(page, node, "/depth_png", _png_of_depth(7, 11, values))
    for x, y in ((0, 0), (6, 1), (3, 2), (5, 8), (6, 9), (2, 10)):
        depth = values[y * 7 + x] / 1000
        assert _point(page, x, y, 7, 11) == f"({x}, {y})  {depth:.3f} m"


def test_a_broken_image_is_a_notice_until_a_good_one_comes(serve, page, node):
    _, address = serve()
    page.goto(panel_address(address, "image", topic="/broken"))
    page.get_by_text("there is no topic /broken").wait_for()
    publisher = node.create_publisher(Image, "/broken")
    notice = page.locator(".notice", has_text="4 x 4 mono8 does not fit its data")
    while not notice.count():
        publisher.publish(_image("mono8", 4, 4, b"abcd"))
        page.wait_for_timeout(50)
    _show(page, node, "/broken", _image("mono8", 2, 2, b"abcd"))
    notice.wait_for(state="hidden")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as PNG").click()
    assert download.value.suggested_filename.startswith("broken_")


def test_a_page_that_cannot_draw_gets_no_more_images_and_then_the_newest(serve, page, node):
    received = []

    def count(socket):
        socket.on("framereceived", lambda data: isinstance(data, bytes) and received.append(data))

    page.on("websocket", count)
    _, address = serve()
    parts = [
        {"panel": "image", "settings": {"topic": "/slow"}},
        {"panel": "topics", "settings": {"topic": "/slow"}},
    ]
    page.goto(f"{address}#{quote(json.dumps({'split': 'row', 'parts': parts, 'sizes': [1, 1]}))}")
    _show(page, node, "/slow", _image("mono8", 1, 1, b"a"))
    page.evaluate("() => { window.held = []; window.requestAnimationFrame = (f) => held.push(f); }")
    about = page.get_by_text(re.compile(r"^\d+ messages?,"))
    already = int(about.inner_text().split()[0])
    before, publisher = len(received), node.create_publisher(Image, "/slow")
    for count in range(1, _MANY + 1):
        publisher.publish(_image("mono8", 1 + count, 1, bytes(1 + count)))
        deadline = time.monotonic() + 40
        while int(about.inner_text().split()[0]) < already + count:  # or one more, of _show
            assert time.monotonic() < deadline, about.inner_text()
            page.wait_for_timeout(50)
    page.wait_for_function("() => held.length")
    assert len(received) - before <= _IN_TRANSIT
    page.evaluate(
        "() => { window.requestAnimationFrame = (f) => setTimeout(f); held.forEach((f) => f()); }"
    )
    page.get_by_text(f"{1 + _MANY} \N{MULTIPLICATION SIGN} 1").wait_for()
