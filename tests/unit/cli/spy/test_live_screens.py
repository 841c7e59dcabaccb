"""The live view's messages, curves and sizes, on a screen that nobody sees."""

import asyncio
import errno
import io
import random
import threading

import pytest
from fixtures.live_view import ROWS, START, S, look
from textual.drivers._writer_thread import WriterThread
from textual.events import Key, Resize
from textual.geometry import Size

from lcmtools.cli.spy.live.app import SpyApp, TerminalFile
from lcmtools.cli.spy.live.rows import RowTable
from lcmtools.cli.spy.live.screens import LivePage, Page
from lcmtools.messages.codec import encode
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.wire.packet import Packet


def vector(x, number):
    message = Vector3()
    message.x = x
    return Packet("POSE", encode(message), START + number * S // 2)


async def open_pose(screen):
    """Look closely at the last channel while eight messages come."""
    await screen.press("end", "enter")
    await screen.until(lambda: "none since this view was opened" in screen.text)
    assert screen.planted.followed == ["POSE"]
    for number in range(8):
        screen.planted.take(vector(float(number), number))
    await screen.until(lambda: "▁▂▃▄▅▆▇█  0 .. 7" in screen.text)


def test_enter_shows_the_message_with_curves_and_enter_again_one_as_large_as_the_screen():
    async def script(screen):
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


def test_details_can_be_paused_and_cleared_and_left():
    async def script(screen):
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


def test_arrays_are_opened_and_closed_and_bytes_are_shown():
    async def script(screen):
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


def test_any_size_will_do_and_the_table_follows_it():
    async def script(screen):
        for width, height in ((80, 24), (40, 8), (12, 3), (200, 60)):
            screen.resize(width, height)
            await screen.until(lambda: screen.app.overview.table.size.width == width)  # noqa: B023
            lines = screen.text.splitlines()
            assert len(lines) <= height
            assert max(map(len, lines)) <= width
            await screen.at_once("enter", "escape", "f6", "escape")
            await screen.until(lambda: screen.is_table)

    look(script)


def test_a_terminal_too_narrow_for_a_screen_ends_nothing():
    async def script(screen):
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


@pytest.mark.parametrize(
    ("keys", "left"),
    [
        (("enter", "enter"), ["Overview", "Detail"]),
        (("f6", "f6"), ["Overview", "SortScreen"]),
        (("question_mark", "question_mark"), ["Overview", "HelpScreen"]),
    ],
)
def test_a_screen_is_opened_once_and_left_once_however_fast_somebody_types(keys, left):
    async def script(screen):
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


def test_a_size_that_the_terminal_has_no_longer_changes_nothing():
    async def script(screen):
        overview, handled = screen.app.overview, asyncio.Event()
        for width in (100, 120):
            overview.post_message(Resize(Size(width, 20), Size(width, 20)))
            overview.call_later(handled.set)
        await handled.wait()
        assert overview.table.size.width == 140

    look(script)


@pytest.mark.parametrize("seed", range(2))
def test_a_storm_of_keys_and_sizes_leaves_the_table_standing(seed, monkeypatch):
    monkeypatch.setattr(LivePage, "period", 0.01)
    chance = random.Random(seed)  # noqa: S311 - no secret
    keys = ["escape", "left", "enter", "enter", "f1", "h", "f6", "f3", "f4", "x", "plus", "c", "r"]

    async def script(screen):
        for number in range(25):
            for key in chance.choices(keys, k=4):
                screen.app.post_message(Key(key, None))
            screen.planted.take(vector(chance.random(), number))
            screen.resize(chance.randint(1, 140), chance.randint(1, 40))
            screen.planted.tell(Snapshot(ROWS[: chance.randint(0, len(ROWS))]))
            await asyncio.sleep(chance.random() / 50)
        await screen.until(lambda: screen.app.overview in screen.app.screen_stack)
        screen.app.action_leave()

    assert look(script) == 0


def test_what_is_written_to_a_closed_terminal_holds_up_nothing():
    class Closed(io.StringIO):
        def write(self, _):
            raise OSError(errno.EIO, "Input/output error")

    writer = WriterThread(TerminalFile(Closed()))
    writer.start()

    def write_and_stop():
        for _ in range(100):  # more than textual's queue takes
            writer.write("text")
        writer.stop()

    ending = threading.Thread(target=write_and_stop, daemon=True)
    ending.start()
    ending.join(30)
    assert not ending.is_alive()


@pytest.mark.parametrize(("group", "stops"), [(7, 1), (5, 0)])
def test_ctrl_z_stops_it_where_a_shell_can_continue_it(monkeypatch, group, stops):
    monkeypatch.setattr("os.getpgrp", lambda: group)
    monkeypatch.setattr("os.getsid", lambda _: 5)
    asked = []
    monkeypatch.setattr(SpyApp, "action_suspend_process", lambda _: asked.append("to stop"))

    async def script(screen):
        await screen.press("ctrl+z")
        assert len(asked) == stops

    look(script)
