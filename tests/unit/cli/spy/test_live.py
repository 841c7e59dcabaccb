"""The live view's keys, on a screen that nobody sees, fed with planted rows and packets."""

import asyncio
import random
from collections.abc import Awaitable, Callable
from dataclasses import replace

import pytest
from textual.app import App
from textual.events import Key
from textual.pilot import Pilot

from lcmtools.cli.spy.live.app import SpyApp
from lcmtools.cli.spy.live.bars import Bar
from lcmtools.cli.spy.live.curve import CurveScreen
from lcmtools.cli.spy.live.detail import Detail
from lcmtools.cli.spy.live.lines import Lines
from lcmtools.cli.spy.live.page import Page
from lcmtools.cli.spy.view import View
from lcmtools.messages.codec import encode
from lcmtools.observe.channels import Row
from lcmtools.observe.feed import Snapshot
from lcmtools.observe.study import Study
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S
ANNOUNCED = Row("", is_announced=True, age=0.0)
ROWS = (
    replace(ANNOUNCED, channel="/arm/joints", types=("sensor_msgs/JointState",), rate=100.0,
            messages=7),
    replace(ANNOUNCED, channel="/base/odom", types=("nav_msgs/Odometry",), rate=50.0,
            messages=900, lost=9, loss=0.1, senders=("/wheels",)),
    replace(ANNOUNCED, channel="/base/scan", types=("sensor_msgs/LaserScan",), rate=10.0,
            messages=30, age=9.0),
    Row("POSE", ("geometry_msgs/Vector3",), rate=1.0, messages=2, age=0.0, listeners=("/ears",)),
    *(Row(f"/z{i:02d}") for i in range(40)),
)  # fmt: skip


class Planted:
    """What a bus would tell."""

    def __init__(self) -> None:
        self.latest = Snapshot(ROWS, ("lcm-sink (pid 7)",))
        self.clears = 0
        self.studies: list[Study] = []
        self.stops = 0

    def clear(self) -> None:
        """Count how often it was asked for."""
        self.clears += 1

    def follow(self, study: Study) -> Callable[[], None]:
        """Take the study, to hear what a test wants it to."""
        self.studies.append(study)

        def stop() -> None:
            self.stops += 1

        return stop


class Screen:
    """The screen, and somebody who types and looks."""

    def __init__(self, app: SpyApp, pilot: Pilot[int], planted: Planted) -> None:
        self.app = app
        self.planted = planted
        self._pilot = pilot

    async def press(self, *keys: str) -> None:
        """Press keys, and let the screen follow."""
        await self._pilot.press(*keys)
        await self._pilot.pause()

    async def until(self, condition: Callable[[], object]) -> None:
        """Wait for something; fails the test when it does not come."""
        for _ in range(400):
            if condition():
                return
            await self._pilot.pause(0.01)
        pytest.fail(f"it never came; there is:\n{self.text}")

    async def resize(self, width: int, height: int) -> None:
        """Make the terminal another size."""
        await self._pilot.resize_terminal(width, height)
        await self._pilot.pause()

    @property
    def text(self) -> str:
        """All that is seen, line by line."""
        strips = self.app.screen._compositor.render_strips()
        return "\n".join(strip.text.rstrip() for strip in strips)

    @property
    def channels(self) -> list[str]:
        """The first word of each line below the heading."""
        lines = self.text.splitlines()
        start = next(i for i, line in enumerate(lines) if line.startswith("CHANNEL"))
        return [line.split()[0] for line in lines[start + 1 : -1] if line.strip()]

    @property
    def cursor(self) -> str | None:
        """What the cursor is on."""
        return self.app.screen.query_one(Lines).cursor_key

    @property
    def title(self) -> str:
        """The line on top."""
        return self.app.screen.query_one("#title", Bar).text


def look(
    script: Callable[[Screen], Awaitable[None]],
    size: tuple[int, int] = (140, 30),
    view: View = View(),  # noqa: B008 - frozen
) -> int | None:
    """Run the live view while a script types; its exit code."""
    planted = Planted()
    app = SpyApp("udpm://239.255.76.67:7667", planted, planted.follow, view)

    async def run() -> None:
        async with app.run_test(size=size) as pilot:
            screen = Screen(app, pilot, planted)
            await screen.until(lambda: screen.title.count("44 channels"))
            await pilot.pause()
            await script(screen)

    asyncio.run(run())
    return app.return_value


def test_the_table_shows_all_columns_and_what_is_known_of_the_bus() -> None:
    async def script(screen: Screen) -> None:
        lines = screen.text.splitlines()
        assert lines[0].startswith("lcmtools spy  udpm://239.255.76.67:7667  44 channels  161.00")
        assert lines[1] == "lcm-sink (pid 7) listens as no node"
        assert lines[2].split()[:4] == ["CHANNEL▲", "TYPE", "MESSAGES", "HZ"]
        assert lines[3].split()[:4] == ["/arm/joints", "sensor_msgs/JointState", "7", "100.00"]
        assert lines[-1].startswith("F1Help")

    look(script)


@pytest.mark.parametrize(
    ("keys", "first"),
    [
        ("n", "POSE"),
        ("r", "/arm/joints"),
        ("m", "/base/odom"),
        ("l", "/base/odom"),
        ("a", "/base/scan"),
        ("s", "/base/odom"),
        ("e", "POSE"),
        ("t", "POSE"),
        ("I", "POSE"),
        ("rI", "POSE"),
        ("rr", "POSE"),
        (">", "POSE"),
        (">>>", "/arm/joints"),
        ("<", "POSE"),
    ],
)
def test_letters_sort_the_table(keys: str, first: str) -> None:
    names = {">": "greater_than_sign", "<": "less_than_sign"}

    async def script(screen: Screen) -> None:
        await screen.press(*(names.get(key, key) for key in keys))
        assert screen.channels[0] == first

    look(script)


def test_f6_lets_somebody_choose_the_column() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("f6", "down", "down", "enter")
        assert screen.app.overview.view.column == "messages"
        assert screen.channels[0] == "/base/odom"
        await screen.press("f6", "home", "escape")
        assert screen.app.overview.view.column == "messages"

    look(script)


def test_the_cursor_stays_on_its_row_while_the_order_changes() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("down")
        assert screen.cursor == "/base/odom"
        await screen.press("r")
        assert (screen.cursor, screen.channels.index("/base/odom")) == ("/base/odom", 1)
        await screen.press("n", "I")
        assert screen.cursor == "/base/odom"
        rows = (Row("/aaa", messages=1), *ROWS)
        screen.planted.latest = replace(screen.planted.latest, rows=rows)
        await screen.until(lambda: "45 channels" in screen.title)
        assert screen.cursor == "/base/odom"

    look(script)


def test_a_table_longer_than_the_screen_is_scrolled() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end")
        assert screen.cursor == "POSE"
        assert screen.channels[-1] == "POSE"
        await screen.press("pageup")
        assert screen.cursor == "/z15"
        await screen.press("home")
        assert (screen.cursor, screen.channels[0]) == ("/arm/joints", "/arm/joints")
        await screen.press("pagedown", "up", "k")
        assert screen.cursor == "/z20"

    look(script)


def test_a_filter_works_while_it_is_typed_and_escape_clears_it() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("f4", *"base")
        assert screen.channels[:2] == ["/base/odom", "/base/scan"]
        assert "2 of 44 channels" in screen.title
        await screen.press("enter", "r")
        assert screen.channels == ["/base/odom", "/base/scan"]
        assert screen.app.overview.view.text == "base"
        await screen.press("escape")
        assert len(screen.channels) > 20
        await screen.press("backslash", "E", "A", "R", "S")
        assert screen.channels[0] == "POSE"
        await screen.press("escape")
        assert len(screen.channels) > 20

    look(script)


def test_a_search_goes_to_the_channel_and_f3_to_the_next() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("slash", *"base")
        assert screen.cursor == "/base/odom"
        await screen.press("f3")
        assert screen.cursor == "/base/scan"
        await screen.press("f3")
        assert screen.cursor == "/base/odom"
        await screen.press("enter", "down")
        assert screen.cursor == "/base/scan"
        assert len(screen.channels) > 20

    look(script)


def test_space_stops_the_display_and_lets_it_go_on() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("space")
        assert "PAUSED" in screen.title
        screen.planted.latest = Snapshot(ROWS[:1])
        await screen.until(lambda: screen.app._shown is screen.planted.latest)
        assert "44 channels" in screen.title
        await screen.press("space")
        screen.planted.latest = Snapshot(ROWS[:2])
        await screen.until(lambda: "2 channels" in screen.title)
        assert "PAUSED" not in screen.title

    look(script)


def test_c_counts_anew_and_trouble_is_told() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("c")
        assert screen.planted.clears == 1
        screen.planted.latest = replace(screen.planted.latest, trouble="the log has ended")
        await screen.until(lambda: "the log has ended" in screen.text)

    look(script)


@pytest.mark.parametrize("key", ["f1", "h", "question_mark"])
def test_help_names_the_keys_and_goes_away(key: str) -> None:
    async def script(screen: Screen) -> None:
        await screen.press(key)
        assert "LCM numbers a sender's" in screen.text
        assert "F10 q Ctrl-C" in screen.text
        await screen.press("escape")
        assert screen.app.screen is screen.app.overview
        await screen.press(key, "enter")
        assert screen.app.screen is screen.app.overview

    look(script)


@pytest.mark.parametrize(
    ("keys", "code"), [(("q",), 0), (("f10",), 0), (("ctrl+c",), 130), (("ctrl+q",), 0),
                       (("enter", "ctrl+c"), 130), (("enter", "f10"), 0), (("f4", "f10"), 0)]
)  # fmt: skip
def test_ways_out(keys: tuple[str, ...], code: int) -> None:
    async def script(screen: Screen) -> None:
        await screen.press(*keys)

    assert look(script) == code


def vector(x: float, i: int) -> Packet:
    message = Vector3()
    message.x = x
    return Packet("POSE", encode(message), START + i * S // 2)


def hear(study: Study, count: int = 8) -> None:
    for i in range(count):
        study.hear(vector(float(i), i))


def test_enter_shows_the_message_with_curves_and_escape_goes_back() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end", "enter")
        (study,) = screen.planted.studies
        assert (study.channel, study.types) == ("POSE", ())
        assert "none since it is looked at closely" in screen.text
        hear(study)
        await screen.until(lambda: "▁▂▃▄▅▆▇█  0 .. 7" in screen.text)
        assert "listeners   /ears" in screen.text
        assert "geometry_msgs/Vector3 by its fingerprint, or" in screen.text
        await screen.press("escape")
        assert screen.app.screen is screen.app.overview
        assert (screen.cursor, screen.planted.stops) == ("POSE", 1)

    look(script)


def test_enter_on_a_number_shows_its_curve_as_large_as_the_screen() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end", "enter")
        hear(screen.planted.studies[0])
        await screen.until(lambda: "▁▂▃▄▅▆▇█" in screen.text)
        await screen.press("enter")
        await screen.until(lambda: "-20 s" in screen.text)
        lines = screen.text.splitlines()
        assert lines[0].startswith("POSE  x  7  8 values, 0 to 7")
        assert lines[1].startswith("  7 ┤")
        assert "-20 s" in lines[-2]
        await screen.press("plus")
        assert "-40 s" in screen.text
        await screen.press("minus", "minus", "minus", "minus", "minus", "minus")
        assert "-2 s" in screen.text
        await screen.press("q", "q")
        assert screen.app.screen is screen.app.overview

    look(script)


def test_arrays_are_opened_and_closed_and_another_type_is_kept_out() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("down", "down", "enter")
        (study,) = screen.planted.studies
        assert study.types == ("sensor_msgs/LaserScan",)
        message = LaserScan()
        message.ranges = tuple(range(30))
        study.hear(Packet("/base/scan", encode(message), START))
        await screen.until(lambda: "▸ ranges" in screen.text)
        screen.app.screen.query_one(Lines).go_to("ranges")
        await screen.press("enter")
        assert "▾ ranges" in screen.text
        assert "[3]" in screen.text
        await screen.press("enter")
        assert "[3]" not in screen.text

    look(script)


def test_a_payload_of_no_known_type_is_shown_as_bytes() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end", "enter")
        screen.planted.studies[0].hear(Packet("POSE", b"no LCM message at all", START))
        await screen.until(lambda: "unknown type, fingerprint" in screen.text)
        assert "no LCM message a" in screen.text

    look(script)


def test_details_can_be_paused_and_cleared() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end", "enter")
        study = screen.planted.studies[0]
        hear(study)
        await screen.until(lambda: "0 .. 7" in screen.text)
        await screen.press("space")
        assert "PAUSED" in screen.title
        study.hear(vector(1000.0, 9))
        await screen.press("down")
        assert "1000" not in screen.text
        await screen.press("space", "c")
        assert study.samples("x") == []

    look(script)


@pytest.mark.parametrize("size", [(80, 24), (200, 60), (40, 8), (12, 3)])
def test_any_size_will_do_and_the_table_follows_it(size: tuple[int, int]) -> None:
    async def script(screen: Screen) -> None:
        for width, height in (size, (100, 20), size):
            await screen.resize(width, height)
            await screen.until(lambda w=width: screen.app.overview.lines.size.width == w)
            lines = screen.text.splitlines()
            assert len(lines) <= height
            assert max(map(len, lines)) <= width
        await screen.press("enter", "enter", "escape", "f1", "escape", "f6", "escape")

    look(script)


def test_a_click_on_a_heading_sorts_and_two_on_a_row_open_it() -> None:
    async def script(screen: Screen) -> None:
        heading = screen.text.splitlines()[2]
        await screen._pilot.click("#table", offset=(heading.index("HZ"), 0))
        assert screen.app.overview.view.column == "rate"
        await screen._pilot.click("#table", offset=(3, 2))
        assert screen.cursor == "/base/odom"
        await screen._pilot.click("#table", offset=(3, 2), times=2)
        await screen.until(lambda: screen.planted.studies)
        assert screen.planted.studies[0].channel == "/base/odom"

    look(script)


def test_it_begins_as_the_command_line_says() -> None:
    async def script(screen: Screen) -> None:
        assert screen.channels == ["/base/scan", "/base/odom"]

    planted_view = View("rate", inverted=True, text="base")
    planted = Planted()
    app = SpyApp("memq://", planted, planted.follow, planted_view)

    async def run() -> None:
        async with app.run_test(size=(100, 20)) as pilot:
            screen = Screen(app, pilot, planted)
            await screen.until(lambda: "2 of 44" in screen.title)
            await script(screen)

    asyncio.run(run())


def test_without_color_no_color_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    planted = Planted()
    app: App[int] = SpyApp("memq://", planted, planted.follow, View())
    assert app.no_color
    assert app.native_ansi_color


def test_a_screen_that_has_no_parts_yet_is_left_alone() -> None:
    async def script(screen: Screen) -> None:
        screen.app.look_closely("/base/scan")
        screen.app._tick()  # comes before the screen has been told to make its parts
        assert not screen.app.screen.is_mounted
        await screen.until(lambda: screen.app.screen.is_mounted)
        await screen.until(lambda: "/base/scan" in screen.title)

    look(script)


async def type_at_once(screen: Screen, *keys: str) -> None:
    """Type faster than screens come and go: each key is sent before the one ahead has worked."""
    for key in keys:
        screen.app.post_message(Key(key, key if len(key) == 1 else None))
    for _ in range(4):
        await screen.press()


@pytest.mark.parametrize(
    ("keys", "left"),
    [
        (("enter", "enter"), ["Overview", "Detail"]),
        (("f6", "f6"), ["Overview", "SortScreen"]),
        (("question_mark", "question_mark"), ["Overview", "HelpScreen"]),
    ],
)
def test_a_screen_is_opened_once_however_fast_somebody_types(
    keys: tuple[str, ...], left: list[str]
) -> None:
    async def script(screen: Screen) -> None:
        await type_at_once(screen, *keys)
        names = [type(one).__name__ for one in screen.app.screen_stack[1:]]
        assert names in (left, ["Overview"])  # or the second was late, and has closed it
        assert len(screen.planted.studies) == left.count("Detail")

    look(script)


@pytest.mark.parametrize("opening", [("enter",), ("f6",), ("f1",)])
@pytest.mark.parametrize("leaving", ["escape", "q"])
def test_a_screen_is_left_once_and_the_table_stays(opening: tuple[str, ...], leaving: str) -> None:
    async def script(screen: Screen) -> None:
        await screen.press(*opening)
        front = screen.app.screen
        assert isinstance(front, Page)
        front.action_back()
        front.action_back()  # was on its way already, and is for nobody else
        front.dismiss("channel")
        await screen.press()
        assert screen.app.screen is screen.app.overview
        await screen.press(*opening)
        await type_at_once(screen, leaving, leaving)
        assert screen.app.overview in screen.app.screen_stack

    look(script)


def test_what_comes_while_a_screen_is_made_or_taken_down_does_no_harm() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("enter")
        screen.planted.studies[0].hear(Packet("/arm/joints", encode(Vector3()), START))
        detail = screen.app.screen
        assert isinstance(detail, Detail)
        detail.action_back()
        await screen.until(lambda: not detail.is_attached)
        detail.take(ROWS[0])  # a late tick; and a late change of size
        detail.on_resize()
        curve = CurveScreen(screen.planted.studies[0], "x")
        curve.take()
        screen.app.push_screen(curve)
        screen.app._tick()
        await screen.press("escape")
        curve.draw()
        assert screen.app.screen is screen.app.overview
        screen.app.action_leave()

    look(script)


@pytest.mark.parametrize("seed", range(4))
def test_a_storm_of_keys_and_sizes_leaves_the_table_standing(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lcmtools.cli.spy.live.app._PERIOD", 0.001)
    chance = random.Random(seed)  # noqa: S311 - no secret
    keys = [
        "escape",
        "left",
        "enter",
        "enter",
        "f1",
        "question_mark",
        "f6",
        "f3",
        "f4",
        "x",
        "plus",
    ]

    async def script(screen: Screen) -> None:
        for _ in range(30):
            for key in chance.choices(keys, k=4):
                screen.app.post_message(Key(key, None))
            await screen._pilot.resize_terminal(chance.randint(1, 140), chance.randint(1, 40))
            screen.planted.latest = Snapshot(ROWS[: chance.randint(0, len(ROWS))])
        await screen.until(lambda: screen.app.overview in screen.app.screen_stack)
        screen.app.action_leave()

    look(script)


@pytest.mark.parametrize(("group", "stops"), [(7, 1), (5, 0)])
def test_ctrl_z_stops_it_where_a_shell_can_continue_it(
    monkeypatch: pytest.MonkeyPatch, group: int, stops: int
) -> None:
    monkeypatch.setattr("os.getpgrp", lambda: group)
    monkeypatch.setattr("os.getsid", lambda _: 5)
    asked = []
    monkeypatch.setattr(SpyApp, "action_suspend_process", lambda _: asked.append("to stop"))

    async def script(screen: Screen) -> None:
        await screen.press("ctrl+z")
        assert len(asked) == stops

    look(script)
