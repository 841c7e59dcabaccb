"""The keys of the live view's table, on a screen that nobody sees."""

import asyncio
from dataclasses import replace

import pytest
from fixtures.live_view import ROWS, Planted, look
from textual.app import App

from lcmtools.cli.spy.live.app import SpyApp
from lcmtools.cli.spy.live.overview import cell_style
from lcmtools.cli.spy.live.rows import Cell, RowTable
from lcmtools.observe.channels.columns import COLUMNS, TableView
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow


def test_the_table_shows_all_columns_and_what_is_known_of_the_bus():
    async def script(screen):
        await screen.until(lambda: "f1 Help" in screen.text)  # keys come when the table has focus
        lines = screen.text.splitlines()
        assert lines[0].startswith("lcmtools spy  udpm://239.255.76.67:7667  44 channels  161.00")
        assert lines[1] == "lcm-sink (pid 7) also listens; it is not a node"
        assert lines[2].split()[:4] == ["CHANNEL▲", "TYPE", "MESSAGES", "HZ"]
        assert lines[3].split()[:4] == ["/arm/joints", "sensor_msgs/JointState", "7", "100.00"]
        assert "f1 Help" in lines[-1]

    look(script)


def test_letters_and_f6_sort_the_table():
    first = {"n": "POSE", "r": "/arm/joints", "m": "/base/odom", "a": "/base/scan", "e": "POSE"}

    async def script(screen):
        for key, channel in first.items():
            await screen.press(key)
            assert (key, screen.channels[0]) == (key, channel)
        await screen.press("n", "I")
        assert screen.channels[0] == "POSE"
        await screen.press("greater_than_sign", "greater_than_sign", "greater_than_sign")
        assert screen.app.overview.view == TableView("rate")
        await screen.press("less_than_sign", "f6", "down", "down", "enter")
        assert screen.app.overview.view == TableView("jitter")
        await screen.press("f6", "home", "escape")
        assert screen.app.overview.view == TableView("jitter")

    look(script)


def test_the_cursor_stays_on_its_row_while_the_order_changes():
    async def script(screen):
        await screen.press("down")
        assert screen.cursor == "/base/odom"
        await screen.press("r")
        assert (screen.cursor, screen.channels.index("/base/odom")) == ("/base/odom", 1)
        await screen.press("n", "I")
        assert screen.cursor == "/base/odom"
        rows = (ChannelRow("/aaa", messages=1), *ROWS)
        screen.planted.tell(replace(screen.planted.latest, rows=rows))
        await screen.until(lambda: "45 channels" in screen.title)
        assert screen.cursor == "/base/odom"
        screen.planted.tell(replace(screen.planted.latest, rows=ROWS[1:]))
        await screen.until(lambda: "43 channels" in screen.title)
        assert screen.cursor == "/base/odom"

    look(script)


def test_a_new_number_draws_its_line_only(monkeypatch):
    drawn = set()
    draw = RowTable.render_line

    def noted(self, y):
        drawn.add(y)
        return draw(self, y)

    async def script(screen):
        monkeypatch.setattr(RowTable, "render_line", noted)
        rows = ROWS[0], replace(ROWS[1], messages=901), *ROWS[2:]
        screen.planted.tell(replace(screen.planted.latest, rows=rows))
        await screen.until(lambda: "901" in screen.text)
        assert drawn == {2}

    look(script)


def test_a_table_longer_than_the_screen_is_scrolled():
    async def script(screen):
        await screen.press("end")
        assert (screen.cursor, screen.channels[-1]) == ("POSE", "POSE")
        await screen.press("home")
        assert (screen.cursor, screen.channels[0]) == ("/arm/joints", "/arm/joints")
        await screen.press("pagedown", "up", "k")
        assert str(screen.cursor) > "/z1"

    look(script)


def test_a_filter_works_while_it_is_typed_and_escape_clears_it():
    async def script(screen):
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


def test_a_search_goes_to_the_channel_and_f3_to_the_next():
    async def script(screen):
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


def test_pause_clear_and_trouble():
    async def script(screen):
        await screen.press("space")
        assert "PAUSED" in screen.title
        screen.planted.tell(Snapshot(ROWS[:1]))
        await screen.pilot.pause(0.5)  # more than two looks at what is new
        assert "44 channels" in screen.title
        await screen.press("space")
        await screen.until(lambda: "1 channel " in screen.title)
        assert "PAUSED" not in screen.title
        await screen.press("c")
        assert screen.planted.clears == 1
        screen.planted.tell(replace(screen.planted.latest, trouble="the log has ended"))
        await screen.until(lambda: "the log has ended" in screen.text)

    look(script)


def test_what_callbacks_raise_is_shown_above_the_table():
    errors = ("/driver: timer 0.02 s raised KeyError 3 times", "/arm: scan raised ValueError once")

    async def script(screen):
        assert "lcm-sink (pid 7) also listens" in screen.text
        screen.planted.tell(replace(screen.planted.latest, callback_errors=errors[:1]))
        await screen.until(lambda: screen.text.splitlines()[1] == errors[0])
        screen.planted.tell(replace(screen.planted.latest, callback_errors=errors))
        more = f"{errors[0]} (and 1 more; see lcmtools wtf)"
        await screen.until(lambda: screen.text.splitlines()[1] == more)
        screen.planted.tell(replace(screen.planted.latest, callback_errors=("/a: \x1b[2J",)))
        await screen.until(lambda: screen.text.splitlines()[1] == r"/a: \x1b[2J")

    look(script)


def test_help_names_the_keys_and_goes_away():
    async def script(screen):
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
def test_ways_out(keys, code):
    async def script(screen):
        await screen.press(*keys)

    assert look(script) == code


def test_a_click_on_a_heading_sorts_and_two_on_a_row_open_it():
    async def script(screen):
        heading = screen.text.splitlines()[2]
        await screen.pilot.click("#table", offset=(heading.index("HZ"), 0))
        assert screen.app.overview.view.column == "rate"
        await screen.pilot.click("#table", offset=(3, 2))
        assert screen.cursor == "/base/odom"
        await screen.pilot.click("#table", offset=(3, 2))
        await screen.until(lambda: screen.planted.followed == ["/base/odom"])

    look(script)


def test_it_begins_as_the_command_line_says():
    async def script(screen):
        assert screen.channels == ["/base/scan", "/base/odom"]

    look(script, TableView("rate", inverted=True, text="base"), "2 of 44")


def test_without_color_no_color_is_sent(monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    app = SpyApp("memq://", Planted(), TableView())
    assert app.no_color
    assert app.native_ansi_color


def test_loss_silence_and_unknown_types_are_seen_at_a_glance():
    def style(column, row):
        return cell_style(row, COLUMNS[column])

    known = ("std_msgs/String",)
    assert style("loss", ChannelRow("A", known, lost=5, loss=0.05, age=0.0)) == "bold red"
    assert style("loss", ChannelRow("A", known, lost=5, loss=0.001, age=0.0)) == "bold yellow"
    assert style("loss", ChannelRow("A", known, lost=0, loss=0.0, age=0.0)) == ""
    assert style("rate", ChannelRow("A", known, age=3.5)) == "dim"
    assert style("rate", ChannelRow("A", known, age=2.5)) == ""
    assert style("type", ChannelRow("A", messages=1, age=0.0)) == "bold yellow"
    assert style("channel", ChannelRow("A")) == "dim"


def test_a_table_that_is_scrolled_may_get_other_columns():
    class Shown(App[None]):
        def compose(self):
            yield RowTable("table")

    keys = [f"row {number}" for number in range(50)]

    async def script():
        app = Shown()
        async with app.run_test(size=(40, 8)) as pilot:
            table = app.query_one(RowTable)
            texts = iter(range(1000))  # another one each time, as rates are
            table.show(
                [("A", 9), ("B", 9)],
                keys,
                lambda key: (Cell(key, key), Cell(key, f"{next(texts)}")),
            )
            await pilot.pause()
            table.scroll_to(y=30, animate=False)
            await pilot.pause()
            assert table.scroll_y > 0
            table.show([("A", 9)], keys[:40], lambda key: (Cell(key, key),))
            await pilot.pause()
            assert (table.row_count, len(table.columns)) == (40, 1)

    asyncio.run(script())
