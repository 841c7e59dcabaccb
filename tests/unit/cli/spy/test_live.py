"""The live view's keys, on a screen that nobody sees, fed with planted rows and packets."""

import asyncio
import errno
import io
import random
import threading
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import TextIO, cast

import pytest
from textual.drivers._writer_thread import WriterThread
from textual.drivers.headless_driver import HeadlessDriver
from textual.events import Key, Resize
from textual.geometry import Size
from textual.pilot import Pilot

from lcmtools.cli.spy.columns import COLUMNS, View
from lcmtools.cli.spy.live.app import SpyApp, TerminalFile
from lcmtools.cli.spy.live.overview import cell_style
from lcmtools.cli.spy.live.rows import Page, RowTable
from lcmtools.messages.codec import encode
from lcmtools.observe.channels import Row
from lcmtools.observe.feed import Snapshot
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
    Row("POSE", ("geometry_msgs/Vector3",), rate=1.0, messages=2, age=0.0,
        listeners=("/monitor",)),
    *(Row(f"/z{i:02d}") for i in range(40)),
)  # fmt: skip


class Planted:
    """A source that a test fills."""

    def __init__(self) -> None:
        self.latest = Snapshot(ROWS, ("lcm-sink (pid 7)",))
        self.clears = 0
        self.followed: list[str] = []
        self.take: Callable[[Packet], None] = lambda _: None
        self.stops = 0

    def clear(self) -> None:
        """Count the calls."""
        self.clears += 1

    def follow(self, channel: str, take: Callable[[Packet], None]) -> Callable[[], None]:
        """Note who follows."""
        self.followed.append(channel)
        self.take = take

        def stop() -> None:
            self.stops += 1

        return stop


class Screen:
    """The screen, and somebody who types and looks."""

    def __init__(self, app: SpyApp, pilot: Pilot[int], planted: Planted) -> None:
        self.app = app
        self.planted = planted
        self.pilot = pilot

    async def press(self, *keys: str) -> None:
        """Press keys, and let the screen follow."""
        await self.pilot.press(*keys)
        await self.pilot.pause()

    async def at_once(self, *keys: str) -> None:
        """Type faster than screens come and go: no key waits for the one before."""
        for key in keys:
            self.app.post_message(Key(key, key if len(key) == 1 else None))
        for _ in range(4):
            await self.pilot.pause()

    def resize(self, width: int, height: int) -> None:
        """Make the terminal another size, and wait for nothing."""
        size = Size(width, height)
        driver = self.app._driver
        assert isinstance(driver, HeadlessDriver)
        driver._size = size
        self.app.post_message(Resize(size, size))

    async def until(self, condition: Callable[[], object]) -> None:
        """Wait for something; fails the test when it does not come."""
        for _ in range(2000):
            if condition():
                return
            await self.pilot.pause(0.01)
        pytest.fail(f"it never came; there is:\n{self.text}")

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
        """The row that the cursor is on."""
        return self.app.screen.query_one(RowTable).cursor_key

    @property
    def title(self) -> str:
        """The line on top."""
        return self.text.split("\n", 1)[0]

    @property
    def is_table(self) -> bool:
        """True if the table is in front."""
        return self.app.screen is self.app.overview


Script = Callable[[Screen], Awaitable[None]]


def look(script: Script, view: View = View(), ready: str = "44 channels") -> int | None:  # noqa: B008 - frozen
    """Run the live view while a script types; its exit code."""
    planted = Planted()
    app = SpyApp("udpm://239.255.76.67:7667", planted, view)

    async def run() -> None:
        async with app.run_test(size=(140, 30)) as pilot:
            screen = Screen(app, pilot, planted)
            await screen.until(lambda: ready in screen.text)
            await pilot.pause()
            await script(screen)

    asyncio.run(run())
    return app.return_value


def test_the_table_shows_all_columns_and_what_is_known_of_the_bus() -> None:
    async def script(screen: Screen) -> None:
        await screen.until(lambda: "f1 Help" in screen.text)  # keys come when the table has focus
        lines = screen.text.splitlines()
        assert lines[0].startswith("lcmtools spy  udpm://239.255.76.67:7667  44 channels  161.00")
        assert lines[1] == "lcm-sink (pid 7) listens as no node"
        assert lines[2].split()[:4] == ["CHANNEL▲", "TYPE", "MESSAGES", "HZ"]
        assert lines[3].split()[:4] == ["/arm/joints", "sensor_msgs/JointState", "7", "100.00"]
        assert "f1 Help" in lines[-1]

    look(script)


def test_letters_and_f6_sort_the_table() -> None:
    first = {"n": "POSE", "r": "/arm/joints", "m": "/base/odom", "a": "/base/scan", "e": "POSE"}

    async def script(screen: Screen) -> None:
        for key, channel in first.items():
            await screen.press(key)
            assert (key, screen.channels[0]) == (key, channel)
        await screen.press("n", "I")
        assert screen.channels[0] == "POSE"
        await screen.press("greater_than_sign", "greater_than_sign", "greater_than_sign")
        assert screen.app.overview.view == View("rate")
        await screen.press("less_than_sign", "f6", "down", "down", "enter")
        assert screen.app.overview.view == View("jitter")
        await screen.press("f6", "home", "escape")
        assert screen.app.overview.view == View("jitter")

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
        screen.planted.latest = replace(screen.planted.latest, rows=ROWS[1:])
        await screen.until(lambda: "43 channels" in screen.title)
        assert screen.cursor == "/base/odom"

    look(script)


def test_a_table_longer_than_the_screen_is_scrolled() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("end")
        assert (screen.cursor, screen.channels[-1]) == ("POSE", "POSE")
        await screen.press("home")
        assert (screen.cursor, screen.channels[0]) == ("/arm/joints", "/arm/joints")
        await screen.press("pagedown", "up", "k")
        assert str(screen.cursor) > "/z1"

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
        await screen.press("backslash", *"MONI")
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


def test_pause_clear_and_trouble() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("space")
        assert "PAUSED" in screen.title
        screen.planted.latest = Snapshot(ROWS[:1])
        await screen.pilot.pause(0.5)  # more than two looks at what is new
        assert "44 channels" in screen.title
        await screen.press("space")
        await screen.until(lambda: "1 channel " in screen.title)
        assert "PAUSED" not in screen.title
        await screen.press("c")
        assert screen.planted.clears == 1
        screen.planted.latest = replace(screen.planted.latest, trouble="the log has ended")
        await screen.until(lambda: "the log has ended" in screen.text)

    look(script)


def test_help_names_the_keys_and_goes_away() -> None:
    async def script(screen: Screen) -> None:
        for key, leave in (("f1", "escape"), ("h", "enter"), ("question_mark", "f1")):
            await screen.press(key)
            assert "LCM numbers a sender's" in screen.text
            assert "F10 q Ctrl-C" in screen.text
            await screen.press(leave)
            assert screen.is_table

    look(script)


@pytest.mark.parametrize(
    ("keys", "code"),
    [(("q",), 0), (("ctrl+q",), 0), (("enter", "ctrl+c"), 130), (("f4", "f10"), 0)],
)
def test_ways_out(keys: tuple[str, ...], code: int) -> None:
    async def script(screen: Screen) -> None:
        await screen.press(*keys)

    assert look(script) == code


def vector(x: float, number: int) -> Packet:
    message = Vector3()
    message.x = x
    return Packet("POSE", encode(message), START + number * S // 2)


async def open_pose(screen: Screen) -> None:
    """Look closely at the last channel while eight messages come."""
    await screen.press("end", "enter")
    await screen.until(lambda: "none since this view was opened" in screen.text)
    assert screen.planted.followed == ["POSE"]
    for number in range(8):
        screen.planted.take(vector(float(number), number))
    await screen.until(lambda: "▁▂▃▄▅▆▇█  0 .. 7" in screen.text)


def test_enter_shows_the_message_with_curves_and_enter_again_one_as_large_as_the_screen() -> None:
    async def script(screen: Screen) -> None:
        await open_pose(screen)
        assert "listeners   /monitor" in screen.text
        assert "geometry_msgs/Vector3 by its fingerprint, or" in screen.text
        await screen.press("enter")
        await screen.until(lambda: "-20 s .. now" in screen.text)
        lines = screen.text.splitlines()
        assert lines[0].startswith("POSE  x  7  8 values, 0 to 7")
        assert (lines[1], lines[-2].split()[0]) == ("7", "0")
        await screen.press("plus")
        assert "-40 s" in screen.text
        await screen.press(*["minus"] * 6, "space")
        assert "-2 s" in screen.text
        assert "PAUSED" in screen.title
        await screen.press("q")
        await screen.until(lambda: "listeners" in screen.text)

    look(script)


def test_details_can_be_paused_and_cleared_and_left() -> None:
    async def script(screen: Screen) -> None:
        await open_pose(screen)
        await screen.press("space")
        assert "PAUSED" in screen.title
        screen.planted.take(vector(1000.0, 9))
        await screen.press("down")
        assert "1000" not in screen.text
        await screen.press("space", "c")
        await screen.until(lambda: "0 .. 7" not in screen.text)
        await screen.press("escape")
        await screen.until(lambda: screen.is_table)
        assert (screen.cursor, screen.planted.stops) == ("POSE", 1)

    look(script)


def test_arrays_are_opened_and_closed_and_bytes_are_shown() -> None:
    async def script(screen: Screen) -> None:
        await screen.press("down", "down", "enter")
        await screen.until(lambda: screen.planted.followed)
        message = LaserScan()
        message.ranges = tuple(range(30))
        screen.planted.take(Packet("/base/scan", encode(message), START))
        await screen.until(lambda: "▸ ranges" in screen.text)
        screen.app.screen.query_one(RowTable).go_to("ranges")
        await screen.press("enter")
        assert "▾ ranges" in screen.text
        assert "[3]" in screen.text
        await screen.press("enter")
        assert "[3]" not in screen.text
        screen.planted.take(Packet("/base/scan", b"no LCM message at all", START + S))
        await screen.until(lambda: "unknown type, fingerprint" in screen.text)
        assert "no LCM message a" in screen.text

    look(script)


def test_any_size_will_do_and_the_table_follows_it() -> None:
    async def script(screen: Screen) -> None:
        for width, height in ((80, 24), (40, 8), (12, 3), (200, 60)):
            screen.resize(width, height)
            await screen.until(lambda: screen.app.overview.table.size.width == width)  # noqa: B023
            lines = screen.text.splitlines()
            assert len(lines) <= height
            assert max(map(len, lines)) <= width
            await screen.at_once("enter", "escape", "f6", "escape")
            await screen.until(lambda: screen.is_table)

    look(script)


def test_a_terminal_too_narrow_for_a_screen_ends_nothing() -> None:
    async def script(screen: Screen) -> None:
        for key in ("f1", "f6", "enter"):
            await screen.press(key)
            await screen.until(lambda: not screen.is_table)
            for width in range(4, 0, -1):
                screen.resize(width, 10)
                await screen.until(lambda: screen.app.screen.size.width == width)  # noqa: B023
            await screen.press("escape")
            await screen.until(lambda: screen.is_table)
            screen.resize(140, 30)
            await screen.until(lambda: screen.app.screen.size.width == 140)

    look(script)


def test_a_click_on_a_heading_sorts_and_two_on_a_row_open_it() -> None:
    async def script(screen: Screen) -> None:
        heading = screen.text.splitlines()[2]
        await screen.pilot.click("#table", offset=(heading.index("HZ"), 0))
        assert screen.app.overview.view.column == "rate"
        await screen.pilot.click("#table", offset=(3, 2))
        assert screen.cursor == "/base/odom"
        await screen.pilot.click("#table", offset=(3, 2))
        await screen.until(lambda: screen.planted.followed == ["/base/odom"])

    look(script)


def test_it_begins_as_the_command_line_says() -> None:
    async def script(screen: Screen) -> None:
        assert screen.channels == ["/base/scan", "/base/odom"]

    look(script, View("rate", inverted=True, text="base"), "2 of 44")


def test_without_color_no_color_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = SpyApp("memq://", Planted(), View())
    assert app.no_color
    assert app.native_ansi_color


@pytest.mark.parametrize(
    ("keys", "left"),
    [
        (("enter", "enter"), ["Overview", "Detail"]),
        (("f6", "f6"), ["Overview", "SortScreen"]),
        (("question_mark", "question_mark"), ["Overview", "HelpScreen"]),
    ],
)
def test_a_screen_is_opened_once_and_left_once_however_fast_somebody_types(
    keys: tuple[str, ...], left: list[str]
) -> None:
    async def script(screen: Screen) -> None:
        await screen.at_once(*keys)
        names = [type(one).__name__ for one in screen.app.screen_stack[1:]]
        assert names in (left, ["Overview"])  # or the second was late, and has closed it
        assert len(screen.planted.followed) <= 1
        if screen.is_table:
            await screen.press(keys[0])
        front = screen.app.screen
        assert isinstance(front, Page)
        front.action_back()
        front.action_back()  # was on its way already, and is for nobody else
        front.dismiss("channel")
        await screen.until(lambda: screen.is_table)
        await screen.press(keys[0])
        await screen.at_once("escape", "escape")
        assert screen.app.overview in screen.app.screen_stack

    look(script)


@pytest.mark.parametrize("seed", range(2))
def test_a_storm_of_keys_and_sizes_leaves_the_table_standing(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lcmtools.cli.spy.live.rows.PERIOD", 0.01)
    chance = random.Random(seed)  # noqa: S311 - no secret
    keys = ["escape", "left", "enter", "enter", "f1", "h", "f6", "f3", "f4", "x", "plus", "c", "r"]

    async def script(screen: Screen) -> None:
        for number in range(25):
            for key in chance.choices(keys, k=4):
                screen.app.post_message(Key(key, None))
            screen.planted.take(vector(chance.random(), number))
            screen.resize(chance.randint(1, 140), chance.randint(1, 40))
            screen.planted.latest = Snapshot(ROWS[: chance.randint(0, len(ROWS))])
            await asyncio.sleep(chance.random() / 50)
        await screen.until(lambda: screen.app.overview in screen.app.screen_stack)
        screen.app.action_leave()

    assert look(script) == 0


def test_what_is_written_to_a_closed_terminal_holds_up_nothing() -> None:
    class Closed(io.StringIO):
        def write(self, _: str) -> int:
            raise OSError(errno.EIO, "Input/output error")

    writer = WriterThread(cast("TextIO", TerminalFile(Closed())))
    writer.start()

    def write_and_stop() -> None:
        for _ in range(100):  # more than textual's queue takes
            writer.write("text")
        writer.stop()

    ending = threading.Thread(target=write_and_stop, daemon=True)
    ending.start()
    ending.join(30)
    assert not ending.is_alive()


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


def test_loss_silence_and_unknown_types_are_seen_at_a_glance() -> None:
    def style(column: str, row: Row) -> object:
        return cell_style(row, COLUMNS[column])

    known = ("std_msgs/String",)
    assert style("loss", Row("A", known, lost=5, loss=0.05, age=0.0)) == "bold red"
    assert style("loss", Row("A", known, lost=5, loss=0.001, age=0.0)) == "bold yellow"
    assert style("loss", Row("A", known, lost=0, loss=0.0, age=0.0)) == ""
    assert style("rate", Row("A", known, age=3.5)) == "dim"
    assert style("rate", Row("A", known, age=2.5)) == ""
    assert style("type", Row("A", messages=1, age=0.0)) == "bold yellow"
    assert style("channel", Row("A")) == "dim"
