"""The pictures per second in a page of the window, in a Chromium without a graphics card.

The page has 1440 x 900 pixels. Its world shows Huskies that stand still, when nothing is to be
drawn, and then drive. Its image panel shows a raw camera image of 640x480 at 30 Hz. The goals are
for two processors. Needs Chromium and playwright, as the window's tests do.
"""

import json
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from urllib.parse import quote

import gui
import lcm
from common import bus, child, every, isolate, parser, show
from playwright.sync_api import BrowserType, Page, sync_playwright

from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import Image

_URL = bus(gui.PORT)
_SECONDS = 10.0
_SETTLED = 5.0  # [s] until the page has chosen how well it draws
_ARGUMENTS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
_SIZE = {"width": 1440, "height": 900}
_COUNT_IMAGES = """
  const draw = CanvasRenderingContext2D.prototype.drawImage;
  CanvasRenderingContext2D.prototype.drawImage = function (...all) {
    globalThis.images = (globalThis.images ?? 0) + 1;
    return draw.apply(this, all);
  };
"""
_OF_WORLD = "() => Number(document.querySelector('.world-stage canvas')?.dataset.frames ?? 0)"
_OF_IMAGE = "() => globalThis.images ?? 0"


def drivers(connection: Connection, count: int) -> None:
    """Drive robots in circles."""
    instance, command = lcm.LCM(_URL), Twist()
    command.linear.x, command.angular.z = 0.5, 0.5
    connection.send(None)
    for _ in every(0.05, 1e6):
        for robot in range(count):
            instance.publish(f"/husky{robot}/cmd_vel", encode(command))


def camera(connection: Connection) -> None:
    """Send images."""
    image = Image(height=480, width=640, encoding="rgb8", step=1920)
    instance = lcm.LCM(_URL)
    connection.send(None)
    for count in every(1 / 30, 1e6):
        image.data = bytes([count % 256]) * (480 * 1920)
        instance.publish("/camera", encode(image))


def _rate(page: Page, script: str) -> float:
    """The rate at which a count in a page grows [Hz]."""
    time.sleep(_SETTLED)
    before, start = page.evaluate(script), time.monotonic()
    time.sleep(_SECONDS)
    return float(page.evaluate(script) - before) / (time.monotonic() - start)


@contextmanager
def _page(chromium: BrowserType, panel: str, settings: Mapping[str, object]) -> Iterator[Page]:
    """A page with one panel."""
    layout = quote(json.dumps({"panel": panel, "settings": settings}))
    with gui.server() as (_, address), tempfile.TemporaryDirectory() as data:
        path = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = chromium.launch_persistent_context(
            data, executable_path=path, args=[*_ARGUMENTS], viewport=_SIZE
        )
        page = browser.new_page()
        page.add_init_script(_COUNT_IMAGES)
        page.goto(f"{address}#{layout}")
        yield page
        browser.close()


def driving(chromium: BrowserType, count: int) -> tuple[float, float]:
    """The rates of pictures of the world while robots drive, and before, while they stand [Hz]."""
    robots = [
        {"model": "husky", "namespace": f"/husky{n}", "pose": [3 * (n % 5), 3 * (n // 5), 0]}
        for n in range(count)
    ]
    with tempfile.TemporaryDirectory() as folder:
        world = Path(folder) / "yard.yaml"
        world.write_text(json.dumps({"node": "yard", "robots": robots}))
        with (
            gui.running("run", "sim", str(world), until="simulating"),
            _page(chromium, "world", {}) as page,
        ):
            still = _rate(page, _OF_WORLD)
            with child(drivers, count) as driver:
                driver.wait()
                return _rate(page, _OF_WORLD), still


def images(chromium: BrowserType) -> float:
    """The rate at which images are drawn [Hz]."""
    with child(camera) as sender, _page(chromium, "image", {"topic": "/camera"}) as page:
        sender.wait()
        return _rate(page, _OF_IMAGE)


def main() -> None:
    """Measure and print."""
    parser(__doc__).parse_args()
    isolate()
    with sync_playwright() as playwright:
        one, still = driving(playwright.chromium, 1)
        ten, _ = driving(playwright.chromium, 10)
        rows = [
            ["a Husky that drives", one, 15],
            ["a Husky that stands still", still, 0],
            ["ten Huskies that drive", ten, 5],
            ["images of 640x480 at 30 Hz", images(playwright.chromium), 20],
        ]
    show("Pictures a second without a graphics card", ["", "Hz", "goal"], rows)


if __name__ == "__main__":
    main()
