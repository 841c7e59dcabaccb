"""Make the pictures of docs/gui.md: pages of the window, with a simulated robot, in Chromium.

    python docs/gui_pictures.py            # all
    python docs/gui_pictures.py steer plot

They are of the light theme, 900 pixels wide; two panels have 1180. It needs Chromium, and the
extras sim and dev.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from PIL import Image
from playwright.sync_api import Page, sync_playwright

_HERE = Path(__file__).parent
_TOOL = str(Path(sysconfig.get_path("scripts")) / "lcmtools")
_BUS = "udpm://239.255.76.67:7695?ttl=0"
_ARGUMENTS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
_SIZE = (900, 520)
_SIZE_OF_TWO = (1180, 520)
_COLORS = 256
_LONG = 40_000  # [ms]


@dataclass(frozen=True, slots=True)
class Shot:
    """A picture.

    Attributes:
        world: What the simulator runs.
        panel: The words behind ``lcmtools gui``.
        act: Called with the page before the picture is taken.
        also: Other commands that run meanwhile.
        two: Two panels side by side with their settings, in place of ``panel``.
        shares: Of the width that these have.
    """

    world: str
    panel: Sequence[str]
    act: Callable[[Page], None]
    also: Sequence[Sequence[str]] = ()
    two: Sequence[dict[str, object]] = ()
    shares: tuple[int, int] = (1, 1)

    def layout(self) -> str:
        """Return the end of the page's address."""
        tree = {"split": "row", "parts": self.two, "sizes": self.shares}
        return f"#{quote(json.dumps(tree))}"


def _steer(page: Page) -> None:
    page.get_by_text("obeyed by").wait_for()
    box = page.locator(".pad").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.36 * box["width"], box["y"] + 0.2 * box["height"])
    page.wait_for_timeout(300)


def _plot(page: Page) -> None:
    page.wait_for_timeout(11_000)
    room = page.locator(".u-over").bounding_box()
    assert room is not None
    page.mouse.move(room["x"] + 0.62 * room["width"], room["y"] + 0.35 * room["height"])
    page.wait_for_timeout(500)


def _image(page: Page) -> None:
    page.get_by_text("640 \N{MULTIPLICATION SIGN} 480").wait_for()
    page.wait_for_timeout(3000)  # until the rate is known
    room = page.locator(".viewport").bounding_box()
    assert room is not None
    page.mouse.move(room["x"] + 0.5 * room["width"], room["y"] + 0.62 * room["height"])
    page.wait_for_timeout(300)


def _call(page: Page) -> None:
    page.get_by_text("of /morse").wait_for()
    form = page.get_by_role("form", name="Call")
    form.get_by_label("robot").fill("husky0")
    form.get_by_role("button", name="Call").click()
    page.get_by_text("answered after").wait_for()
    gain = page.get_by_label("kp")
    gain.fill("12.5")
    gain.press("Enter")
    page.get_by_text("is now 12.5").wait_for()


def _frames(page: Page) -> None:
    page.locator("[data-pose]").first.wait_for(state="attached")
    page.locator(".world-stage").focus()
    for key in [*"++++++++", *["ArrowUp"] * 4]:
        page.keyboard.press(key)
    page.wait_for_timeout(3000)


def _record(page: Page) -> None:
    page.get_by_label("/husky0/odometry", exact=True).wait_for()
    page.get_by_role("button", name="Record").click()
    page.wait_for_timeout(24_000)


_KEYS = "up up up up 1.5 left left 2 right right right right 2 left left down down 1.5 space 1"
_TWIST = "{linear: {x: 0.5}, angular: {z: 0.3}}"
_CIRCLE = (_TOOL, "pub", "-r", "10", "/husky0/cmd_vel", "geometry_msgs/Twist", _TWIST)
_PLACE = "/husky0/odometry/pose.pose.position"
SHOTS = {
    "steer": Shot("husky", ("steer", "/husky0/cmd_vel"), _steer),
    "plot": Shot(
        "husky",
        (
            "plot",
            "/husky0/cmd_vel/linear.x",
            "/husky0/odometry/twist.twist.linear.x",
            "/husky0/odometry/twist.twist.angular.z",
        ),
        _plot,
        [(_TOOL, "run", "steering", "/husky0/cmd_vel")],
    ),
    "image": Shot("pioneer", ("image", "/camera/depth/image_raw"), _image),
    "services": Shot(
        "husky",
        (),
        _call,
        [(_TOOL, "run", "simple_controller", "__ns:=/husky0")],
        (
            {"panel": "services", "settings": {"service": "/morse/get_state"}},
            {"panel": "parameters", "settings": {"node": "/husky0/simple_controller"}},
        ),
    ),
    "frames": Shot(
        "husky",
        (),
        _frames,
        (),
        (
            {"panel": "frames"},
            {"panel": "world", "settings": {"axes": True, "side": False}},
        ),
    ),
    "record": Shot(
        "husky",
        (),
        _record,
        [_CIRCLE],
        (
            {
                "panel": "record",
                "settings": {"topics": ["/husky0/cmd_vel", "/husky0/odometry"]},
            },
            {
                "panel": "plot",
                "settings": {
                    "fields": [f"{_PLACE}.x", f"{_PLACE}.y"],
                    "x": f"{_PLACE}.x",
                    "window": 30,
                },
            },
        ),
        (2, 3),
    ),
}
"""By name of the file without gui_ and .png."""


def take(name: str) -> None:
    """Take one picture."""
    shot = SHOTS[name]
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    size, file = _SIZE_OF_TWO if shot.two else _SIZE, _HERE / f"gui_{name}.png"
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="rides_"))
        stack.enter_context(_running([_TOOL, "run", "sim", shot.world], "simulating"))
        words = [_TOOL, "gui", *shot.panel, "--port", "0", "--no-open"]
        words += ["--record-directory", folder]
        address = stack.enter_context(_running(words, "http://"))
        for command in shot.also:
            stack.enter_context(_driven(command))
        playwright = stack.enter_context(sync_playwright())
        browser = playwright.chromium.launch(executable_path=chromium, args=[*_ARGUMENTS])
        page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        page.set_default_timeout(_LONG)
        page.goto(re.findall(r"http://\S+", address)[0] + (shot.layout() if shot.two else ""))
        shot.act(page)
        page.screenshot(path=file)
        browser.close()
    with Image.open(file) as image:
        image.convert("RGB").quantize(_COLORS).save(file, optimize=True)


@contextmanager
def _running(command: Sequence[str], mark: str) -> Iterator[str]:
    """Run a command while the block runs; yield its first line with a mark."""
    environment = {**os.environ, "LCM_DEFAULT_URL": _BUS, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        assert process.stdout is not None
        try:
            yield next(line for line in process.stdout if mark in line)
        finally:
            process.terminate()


@contextmanager
def _driven(command: Sequence[str]) -> Iterator[None]:
    """Run a command that reads keys while the block runs."""
    environment = {**os.environ, "LCM_DEFAULT_URL": _BUS}
    quiet = subprocess.DEVNULL
    with subprocess.Popen(
        command, env=environment, text=True, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet
    ) as process:
        assert process.stdin is not None
        process.stdin.write(" ".join([_KEYS] * 4))
        process.stdin.flush()
        try:
            yield
        finally:
            process.terminate()


if __name__ == "__main__":
    for picture in sys.argv[1:] or SHOTS:
        take(picture)
