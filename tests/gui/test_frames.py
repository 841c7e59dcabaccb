"""Coordinate frames: their tree in a panel, and their axes in the world."""

import io
import json
import time
from urllib.parse import quote

import numpy as np
import pytest
from PIL import Image

from lcmtools.bus.open import open_bus
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.tf2_msgs import TFMessage
from tests.gui.conftest import open_more

_SATURATED = 90  # a color's distance from the others, of 255
_FEW = 10  # pixels


@pytest.fixture
def bus(bus_url):
    """A program that publishes."""
    opened = open_bus(parse_url(bus_url))
    yield opened
    opened.close()


@pytest.fixture
def address(start, lcmtools_path, bus_url):
    """The address of a window with the tree of frames beside the world."""
    about = ("--port", "0", "--no-open", "--lcm-url", bus_url)
    start_of = start(lcmtools_path, "gui", *about).wait_for("http://").split()[-1]
    parts = [{"panel": "frames"}, {"panel": "world"}]
    layout = {"split": "row", "parts": parts, "sizes": [1, 1]}
    return f"{start_of}#{quote(json.dumps(layout))}"


def send(bus, topic, *pairs):
    """Publish transforms, each given as "parent child"."""
    message = TFMessage()
    for height, pair in enumerate(pairs):
        one = TransformStamped()
        one.header.frame_id, one.child_frame_id = pair.split()
        one.transform.translation.z, one.transform.rotation.w = 0.2 * height, 1.0
        message.transforms.append(one)
    bus.publish(topic, encode(message))


def rows(page):
    """The rows of the tree: frame, level, topic and fault."""
    return [
        [cells[0], row.get_attribute("aria-level"), cells[4], cells[2]]
        for row in page.locator(".frame-tree tbody tr").all()
        for cells in [row.locator("td").all_text_contents()]
    ]


def test_the_tree_has_each_frame_below_its_parent_and_names_what_is_wrong(address, bus, page):
    page.goto(address)
    page.get_by_text("no topic has transforms").wait_for()
    send(bus, "/tf", "world odom", "odom base")
    page.locator(".frame-tree tbody tr").nth(2).wait_for()
    assert rows(page) == [
        ["world", "1", "", ""],
        ["odom", "2", "/tf", ""],
        ["base", "3", "/tf", ""],
    ]
    assert page.locator(".frame-tree tbody td").nth(8).inner_text()  # its publisher
    send(bus, "/other", "map lidar")
    page.get_by_text("2 trees that nothing connects: map, world").wait_for()
    send(bus, "/tf", "odom base", "lidar base")
    page.get_by_text("also in lidar, by ").wait_for()
    send(bus, "/tf", "hen egg", "egg hen")
    page.get_by_text("a loop: egg in hen in egg").wait_for()


def test_the_world_shows_the_axes_of_frames(address, bus, page):
    page.goto(address)
    page.locator(".world-stage canvas").wait_for()
    page.locator(".frame-tree").wait_for()
    send(bus, "/tf", "world odom", "odom base")
    page.locator(".frame-tree tbody tr").nth(2).wait_for()
    open_more(page)
    frames = page.get_by_role("button", name="Frames", exact=True)
    assert frames.get_attribute("aria-pressed") == "false"
    assert _saturated(page) == [0, 0, 0]
    frames.click()
    _until(lambda: min(_saturated(page)) > _FEW)
    frames.click()
    _until(lambda: max(_saturated(page)) == 0)


def _saturated(page):
    """Return the number of red, green and blue pixels of the world."""
    picture = Image.open(io.BytesIO(page.locator(".world-stage canvas").screenshot()))
    pixels = np.asarray(picture.convert("RGB"), int)
    others = [np.delete(pixels, color, axis=2).max(axis=2) for color in range(3)]
    return [int((pixels[:, :, color] > others[color] + _SATURATED).sum()) for color in range(3)]


def _until(condition):
    deadline = time.monotonic() + 40.0
    while not condition():
        assert time.monotonic() < deadline
