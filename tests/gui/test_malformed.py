"""Messages that cannot be shown: each display says what is wrong, and the others go on."""

import io
import math

import pytest
from PIL import Image as Picture

from lcmtools.bus.open import open_bus
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft
from lcmtools.types.geometry_msgs import PoseArray, PoseStamped
from lcmtools.types.nav_msgs import OccupancyGrid, Odometry, Path
from lcmtools.types.sensor_msgs import CompressedImage, Image, LaserScan, PointCloud, PointCloud2
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker, MarkerArray

WORLD = {"header": {"frame_id": "world"}}
AWAY = {"x": math.nan}
FAR = {"x": 1e300}
CUBE = {**WORLD, "type": 1, "scale": {"x": 1, "y": 1, "z": 1}, "color": {"a": 1}}
CELLS = {"width": 2, "height": 2, "resolution": 0.1}
POINTS = [AWAY, {}, {}]


def transform(parent, child, **place):
    return {
        "header": {"frame_id": parent},
        "child_frame_id": child,
        "transform": {"translation": place, "rotation": {"w": 1}},
    }


DISPLAYS = [
    (TFMessage, {"transforms": [transform("", "")]}, "it has an empty name"),
    (TFMessage, {"transforms": [transform("a", "a")]}, "it is its own parent"),
    (TFMessage, {"transforms": [transform("a", "b", **AWAY)]}, "its place is not finite"),
    (TFMessage, {"transforms": [transform("a", "b", **FAR)]}, "its place is not finite"),
    (Marker, {**CUBE, "pose": {"position": AWAY}}, "0 markers, 1 not drawn: their places"),
    (Marker, {**CUBE, "type": 99}, "1 not drawn: their types are unknown"),
    (Marker, {**CUBE, "type": -1}, "1 not drawn: their types are unknown"),
    (Marker, {**CUBE, "scale": {}}, "1 not drawn: their scale is 0"),
    (Marker, {**CUBE, "type": 0, "scale": {"x": 1}}, "1 not drawn: their scale is 0"),
    (Marker, {**CUBE, "color": {"r": 1}}, "1 not drawn: their color.a is 0"),
    (Marker, {**CUBE, "header": {}}, "its frame_id is empty"),
    (Marker, {**CUBE, "type": 10}, "1 not drawn: files that messages name are not read"),
    (MarkerArray, {"markers": [CUBE, {**CUBE, "id": 1, "type": 99}]}, "2 markers, 1 not drawn"),
    (LaserScan, {**WORLD, "range_min": 2, "range_max": 1}, "range_min is 2 and range_max 1"),
    (LaserScan, {**WORLD, "angle_increment": math.nan}, "not drawn: its place is not finite"),
    (LaserScan, {}, "its frame_id is empty"),
    (PointCloud, {**WORLD, "points": POINTS}, "1 not drawn: their places are not finite"),
    (PointCloud2, {**WORLD, "width": 2, "height": 1}, "it has no x, y and z"),
    (PointCloud2, {**WORLD, "width": 2, "height": 1, "point_step": 8}, "need 16 bytes"),
    (Path, {**WORLD, "poses": [{"pose": {"position": AWAY}}]}, "1 not drawn: their places"),
    (PoseStamped, {**WORLD, "pose": {"position": AWAY}}, "not drawn: its place is not finite"),
    (PoseStamped, {**WORLD, "pose": {"position": FAR}}, "not drawn: its place is not finite"),
    (PoseStamped, {"header": {"frame_id": "nowhere"}}, "no transform from nowhere to "),
    (PoseArray, {**WORLD, "poses": [{"position": AWAY}, {}]}, "1 not drawn: their places"),
    (Odometry, {**WORLD, "pose": {"pose": {"position": AWAY}}}, "its place is not finite"),
    (Odometry, {}, "its frame_id is empty"),
    (OccupancyGrid, {**WORLD, "info": CELLS}, "2 x 2 cells, but data has 0"),
    (OccupancyGrid, {**WORLD, "info": {**CELLS, "resolution": 0}, "data": [0] * 4}, "is 0 m"),
]
IMAGES = [
    (Image, {"width": 4, "height": 2, "encoding": "rgb8", "step": 11, "data": b"\0" * 24}, "11"),
    (Image, {"width": 4, "height": 2, "encoding": "rgb8", "step": 12, "data": b"\0" * 23}, "23"),
    (Image, {"width": 4, "height": 2, "encoding": "?", "step": 4, "data": b"\0" * 8}, "'?'"),
    (Image, {"encoding": "mono8"}, "0 x 0"),
    (CompressedImage, {"format": "bmp", "data": b"BM"}, "'bmp' are not shown"),
    (CompressedImage, {"format": "jpeg", "data": b"\xff\xd8\xff\0"}, "the image cannot be read"),
    (CompressedImage, {"format": "png", "data": b"\x89PNG\r\n\x1a\n"}, "'png' are not shown"),
    (PoseStamped, {}, "has no images: its messages are geometry_msgs/PoseStamped"),
]


@pytest.fixture
def bus(bus_url):
    """A program that publishes."""
    opened = open_bus(parse_url(bus_url))
    yield opened
    opened.close()


@pytest.fixture
def window(start, lcmtools_path, bus_url):
    """``window("world")``: the address of a window."""

    def run(*words):
        about = ("--port", "0", "--no-open", "--lcm-url", bus_url)
        server = start(lcmtools_path, "gui", *words, *about)
        return server.wait_for("http://").split()[-1]

    return run


def made(kind, values):
    """A message with some values; others are the type's defaults."""
    found = draft(kind, dict(values)).message
    return found


def test_each_display_of_the_world_says_what_is_wrong_and_the_others_go_on(window, bus, page):
    page.goto(window("world"))
    page.locator(".world-stage canvas").wait_for()
    bus.publish("/good", encode(made(PoseStamped, WORLD)))
    for number, (kind, values, _) in enumerate(DISPLAYS):
        bus.publish(f"/{number:02}", encode(made(kind, values)))
    rows = page.locator(".world-displays li")
    page.wait_for_function(
        "n => document.querySelectorAll('.world-displays li').length === n", arg=len(DISPLAYS) + 1
    )
    for box in rows.locator("input[type=checkbox]").all():
        box.check()
    for number, (kind, _, text) in enumerate(DISPLAYS):
        row = rows.filter(has=page.get_by_text(f"/{number:02}", exact=True))
        row.get_by_text(text).wait_for(timeout=10_000)
        assert "is-bad" in (row.get_attribute("class") or ""), (kind, text)
    good = rows.filter(has=page.get_by_text("/good", exact=True))
    assert good.locator("small").inner_text() == "pose"
    before = int(page.locator(".world-stage canvas").get_attribute("data-frames"))
    bus.publish("/good", encode(made(PoseStamped, {**WORLD, "pose": {"position": {"x": 1}}})))
    page.wait_for_function(
        "n => document.querySelector('.world-stage canvas').dataset.frames > n", arg=before
    )


def test_a_damaged_jpeg_file_after_a_good_one_stops_nothing(window, bus, page):
    page.goto(window("image", "/camera"))
    page.locator(".panel-body > *").wait_for()
    for width in (20, 30):
        jpeg = io.BytesIO()
        Picture.new("RGB", (width, 10)).save(jpeg, "JPEG")
        for data in (jpeg.getvalue(), jpeg.getvalue()[:200]):
            bus.publish("/camera", encode(made(CompressedImage, {"format": "jpeg", "data": data})))
            page.get_by_text(f"{width} \N{MULTIPLICATION SIGN} 10").wait_for(timeout=10_000)
            notice = page.get_by_text("the image cannot be read")
            notice.wait_for(
                state="hidden" if data == jpeg.getvalue() else "visible", timeout=10_000
            )


def test_an_image_panel_says_what_is_wrong_and_shows_the_next_image(window, bus, page):
    page.goto(window("image", "/camera"))
    page.locator(".panel-body > *").wait_for()
    pixels = {"width": 2, "height": 1, "encoding": "rgb8", "step": 6, "data": b"\0" * 6}
    for kind, values, text in IMAGES:
        bus.publish("/camera", encode(made(kind, values)))
        page.locator(".panel").get_by_text(text).first.wait_for(timeout=10_000)
        bus.publish("/camera", encode(made(Image, pixels)))
        page.get_by_text("2 \N{MULTIPLICATION SIGN} 1").wait_for(timeout=10_000)
        page.locator(".notice").wait_for(state="hidden")
