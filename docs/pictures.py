"""Draw the pictures of the simulator's worlds, and of the window that shows one, in docs again.

    python docs/pictures.py [LAB... or window]

It starts each lab's simulator, opens ``lcmtools gui`` in Chromium without a display, lets the
robot drive, and takes a picture of what is drawn. It needs Chromium and the extra
``dev``; without a graphics card it draws by software.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

from PIL import Image
from playwright.sync_api import sync_playwright

_FOLDER = Path(__file__).parent
_BUS = {**os.environ, "LCM_DEFAULT_URL": "udpm://239.255.76.67:7799?ttl=0"}
_ARGUMENTS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
_SIZE = {"width": 1280, "height": 800}
_LOOK = 0.05  # [s] between two at the clock
_LONG = 120_000  # [ms] for a picture of a page that is drawn by software
_SETTLING = 5.0  # [s] until nothing is said any more
_COLORS = 256  # of a picture's palette: a third of the size


@dataclass(frozen=True)
class Picture:
    """A picture of one lab.

    Attributes:
        world: That is simulated.
        topic: That drives the robot.
        speeds: Forward [m/s] and turning [rad/s].
        seconds: Simulated ones of driving before the picture.
        settings: Of the panel.
        beside: A column of other panels, which the picture then shows too.
    """

    world: str
    topic: str
    speeds: tuple[float, float]
    seconds: float
    settings: dict[str, object] = field(default_factory=dict)
    beside: tuple[dict[str, object], ...] = ()

    def view(self) -> dict[str, object]:
        """Return the layout of the page."""
        world = {"panel": "world", "settings": {"side": False, **self.settings}}
        if not self.beside:
            return world
        column = {"split": "column", "parts": list(self.beside), "sizes": [1, 1]}
        return {"split": "row", "parts": [column, world], "sizes": [2, 3]}


PICTURES = {
    "husky": Picture("husky", "/husky0/cmd_vel", (0.5, 0.3), 8.0),
    "pioneer": Picture(
        "pioneer",
        "/RosAria/cmd_vel",
        (0.12, 0.05),
        6.0,
        {"shown": {"/camera/depth/points": True}, "colors": {"/camera/depth/points": "#3b8fe0"}},
    ),
    "dolly": Picture("dolly", "/dolly/cmd_vel", (0.5, 0.3), 18.0),
    "window": Picture(
        "husky",
        "/husky0/cmd_vel",
        (0.5, 0.3),
        10.0,
        {"follow": "husky0"},
        (
            {"panel": "topics", "settings": {}},
            {
                "panel": "plot",
                "settings": {
                    "fields": [
                        "/husky0/odometry/pose.pose.position.x",
                        "/husky0/odometry/pose.pose.position.y",
                    ]
                },
            },
        ),
    ),
}


def main(names: Sequence[str]) -> None:
    """Draw these pictures, or all."""
    for name in names or PICTURES:
        _draw(PICTURES[name], _FOLDER / f"{name}.png")


def _draw(picture: Picture, file: Path) -> None:
    forward, turning = picture.speeds
    twist = f"{{linear: {{x: {forward}}}, angular: {{z: {turning}}}}}"
    with ExitStack() as stack:
        enter = stack.enter_context
        enter(_started("run", "sim", picture.world))
        window = enter(_started("gui", "--port", "0", "--no-open"))
        address = next(line for line in window if "http://" in line).split()[1]
        page = enter(_opened_page())
        page.goto(f"{address}#{quote(json.dumps(picture.view()))}")
        page.locator("[data-pose]").first.wait_for(state="attached")
        enter(_started("pub", "-r", "5", picture.topic, "geometry_msgs/Twist", twist))
        began = _time(page)
        while _time(page) < began + picture.seconds:
            time.sleep(_LOOK)
        if not picture.beside:  # panels that show rates need a running simulator
            page.get_by_role("button", name="Pause", exact=True).click()
        page.get_by_role("button", name="Reset view").click()
        time.sleep(_SETTLING)
        part = page if picture.beside else page.locator(".world-stage")
        part.screenshot(path=file, timeout=_LONG)
    _make_small(file)


@contextmanager
def _started(*words: str) -> Iterator[Iterator[str]]:
    """A command of lcmtools, and the lines that it says."""
    with subprocess.Popen(["lcmtools", *words], env=_BUS, stderr=subprocess.PIPE, text=True) as one:
        assert one.stderr is not None, "it is a pipe"
        try:
            yield iter(one.stderr)
        finally:
            one.terminate()


@contextmanager
def _opened_page() -> Iterator[Any]:
    with sync_playwright() as playwright:
        chromium = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(executable_path=chromium, args=[*_ARGUMENTS])
        yield browser.new_page(viewport=_SIZE, color_scheme="light")
        browser.close()


def _time(page: Any) -> float:  # noqa: ANN401 - playwright's
    """The simulated time that the page shows [s]."""
    return float(page.locator(".world-simulator output").inner_text().split()[0])


def _make_small(file: Path) -> None:
    """Write a picture in half its size, and few colours, in place of the file."""
    with Image.open(file) as image:
        size = tuple(math.ceil(side * 0.66) for side in image.size)
        small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
        small.quantize(_COLORS, dither=Image.Dither.FLOYDSTEINBERG).save(file, optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
