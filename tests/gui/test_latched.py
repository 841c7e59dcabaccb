"""Latched messages of any size and language are in every panel, after a server's restart too."""

import json
import signal
import socket
from functools import partial
from urllib.parse import quote

from lcmtools import Node
from lcmtools.messages.message_template import draft
from lcmtools.types.nav_msgs import OccupancyGrid
from lcmtools.types.sensor_msgs import Image
from lcmtools.types.std_msgs import Float64, String
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools_sim.view import LatchedPublisher

TEXT = "Grüße, 日本語 🤖 שלום"
CELLS = {"width": 400, "height": 400, "resolution": 0.05}
PIXELS = {"width": 320, "height": 240, "encoding": "rgb8", "step": 960, "data": bytes(960 * 240)}
MESSAGES = {
    "/text": (String, {"data": TEXT}),
    "/number": (Float64, {"data": 2.5}),
    "/image": (Image, PIXELS),
    "/map": (OccupancyGrid, {"header": {"frame_id": "map"}, "info": CELLS, "data": [0] * 160_000}),
    "/tf_static": (
        TFMessage,
        {"transforms": [{"header": {"frame_id": "map"}, "child_frame_id": "odom"}]},
    ),
}
PANELS = [
    {"panel": "topics", "settings": {"topic": "/text"}},
    {"panel": "plot", "settings": {"fields": ["/number/data"]}},
    {"panel": "image", "settings": {"topic": "/image"}},
    {"panel": "frames"},
    {"panel": "world"},
]


def latching():
    """A node that publishes the messages to each new subscriber."""
    node = Node("latching")
    for topic, (kind, values) in MESSAGES.items():
        message = partial(getattr, draft(kind, values), "message")
        LatchedPublisher(node, kind, topic, message, lambda: False)
    return node


def shows_all(page):
    """Wait until each panel shows its message."""
    page.get_by_role("tree").get_by_text(f'"{TEXT}"', exact=True).wait_for()
    page.locator(".plot-table td", has_text="2.50000").wait_for()
    page.locator("[data-panel=image]").get_by_text("320 \N{MULTIPLICATION SIGN} 240").wait_for()
    page.locator(".frame-tree tbody tr", has_text="odom").wait_for()
    page.locator(".world-displays li", has_text="/map").get_by_text("map", exact=True).wait_for()


def test_each_panel_shows_what_is_latched_to_pages_opened_at_any_time(
    module_start_node, module_start, lcmtools_path, page
):
    module_start_node(latching)
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    command = (lcmtools_path, "gui", "--no-open", "--port", port)
    layout = {"split": "row", "parts": PANELS, "sizes": [1] * len(PANELS)}
    for _ in range(2):
        server = module_start(*command)
        address = server.wait_for("http://").split()[-1]
        for _ in range(2):  # the second one when the server has long been subscribed
            page.goto("about:blank")
            page.goto(f"{address}#{quote(json.dumps(layout))}")
            shows_all(page)
        server.send_signal(signal.SIGINT)
        server.wait()
