"""Draw the pictures of the simulator's worlds in docs again.

    python docs/pictures.py [LAB...]

It starts each lab's simulator, opens ``lcmtools gui world`` in Chromium without a display, lets the
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
_SETTLING = 5.0  # [s] until nothing is said any more
_COLORS = 256  # of a picture's palette: a third of the size


@dataclass(frozen=True)
class Picture:
    """A picture of one lab.

    Attributes:
        topic: That drives the robot.
        speeds: Forward [m/s] and turning [rad/s].
        seconds: Simulated ones of driving before the picture.
        settings: Of the panel.
    """

    topic: str
    speeds: tuple[float, float]
    seconds: float
    settings: dict[str, object] = field(default_factory=dict)


PICTURES = {
    "husky": Picture("/husky0/cmd_vel", (0.5, 0.3), 8.0),
    "pioneer": Picture(
        "/RosAria/cmd_vel",
        (0.12, 0.05),
        6.0,
        {"shown": {"/camera/depth/points": True}, "colors": {"/camera/depth/points": "#3b8fe0"}},
    ),
    "dolly": Picture("/dolly/cmd_vel", (0.5, 0.3), 18.0),
}


def main(names: Sequence[str]) -> None:
    """Draw the pictures of these labs, or of all."""
    for name in names or PICTURES:
        _draw(PICTURES[name], name, _FOLDER / f"{name}.png")


def _draw(picture: Picture, world: str, file: Path) -> None:
    forward, turning = picture.speeds
    twist = f"{{linear: {{x: {forward}}}, angular: {{z: {turning}}}}}"
    with ExitStack() as stack:
        enter = stack.enter_context
        enter(_started("run", "sim", world))
        window = enter(_started("gui", "world", "--port", "0", "--no-open"))
        address = next(line for line in window if "http://" in line).split()[-1]
        page = enter(_opened_page())
        view = {"panel": "world", "settings": {"side": False, **picture.settings}}
        page.goto(f"{address}#{quote(json.dumps(view))}")
        page.locator("[data-pose]").first.wait_for(state="attached")
        enter(_started("pub", "-r", "5", picture.topic, "geometry_msgs/Twist", twist))
        began = _time(page)
        while _time(page) < began + picture.seconds:
            time.sleep(_LOOK)
        page.get_by_role("button", name="Pause").click()
        page.get_by_role("button", name="Reset view").click()
        time.sleep(_SETTLING)
        page.locator(".world-stage").screenshot(path=file)
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
