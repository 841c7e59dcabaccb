"""The app of the live view."""

import asyncio
import gc
import os
from contextlib import suppress
from io import TextIOWrapper
from typing import Any, ClassVar, TextIO, cast

from textual.app import App
from textual.binding import Binding, BindingType
from textual.drivers.linux_driver import LinuxDriver
from textual.events import Event, InputEvent

from lcmtools.cli.ending import BY_SIGNAL, INTERRUPTED
from lcmtools.cli.spy.live.overview import Overview
from lcmtools.cli.spy.live.screens import HelpScreen
from lcmtools.observe.channels.columns import TableView
from lcmtools.observe.channels.feed import Feed
from lcmtools.observe.channels.rows import ChannelSelection
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.signals import ENDING

_PERIOD = 1.0  # [s] between two drawings of the table where nothing but numbers changes


class TerminalFile:
    """A terminal's stream that drops what is written after the terminal has closed.

    textual's writing thread would end with the first error, and the app wait for it forever.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file

    def write(self, text: str) -> None:
        with suppress(OSError):
            self._file.write(text)

    def flush(self) -> None:
        with suppress(OSError):
            self._file.flush()

    def __getattr__(self, name: str) -> object:
        return getattr(self._file, name)


class TerminalDriver(LinuxDriver):
    """A driver that outlives its terminal, so that the app can end."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - as its base
        super().__init__(*arguments, **options)
        self._file = cast("TextIOWrapper", TerminalFile(cast("TextIO", self._file)))


class SpyApp(App[int]):
    """The live view of the bus ``bus``; its result is the exit code."""

    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Screen { background: ansi_default; color: ansi_default; overflow: hidden; }
    #title { height: auto; text-wrap: nowrap; text-overflow: ellipsis; }
    RowTable { height: 1fr; overflow-x: hidden; scrollbar-gutter: stable;
        scrollbar-size-vertical: 1; color: ansi_default;
        background: ansi_default; background-tint: ansi_default 0%; }
    RowTable > .datatable--header, RowTable:focus > .datatable--header,
    RowTable > .datatable--header-hover { background: ansi_green; color: ansi_black; }
    RowTable > .datatable--cursor, RowTable:focus > .datatable--cursor {
        background: ansi_cyan; color: ansi_black; }
    RowTable > .datatable--hover { background: ansi_default; }
    #prompt { height: 1; }
    SortScreen, HelpScreen { align: center middle; background: transparent; }
    SortScreen OptionList { text-overflow: ellipsis; }  /* fold fails without a width */
    SortScreen OptionList, HelpScreen VerticalScroll {
        width: 24; max-width: 100%; height: auto; max-height: 100%; border: round ansi_cyan; }
    HelpScreen VerticalScroll { width: 74; }
    CurveScreen Horizontal { height: 1fr; align-horizontal: right; }
    #curve { height: 1fr; }
    #curve > .sparkline--max-color, #curve > .sparkline--min-color { color: ansi_cyan; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f10", "leave", "Quit", priority=True),
        Binding("ctrl+q", "leave", "Quit", show=False, priority=True),
        Binding("ctrl+c", "interrupt", "Quit", show=False, priority=True),
        Binding("ctrl+z", "suspend", "To the shell", show=False, priority=True),
    ]

    def __init__(self, bus: str, feed: Feed, view: TableView) -> None:
        super().__init__(driver_class=TerminalDriver, ansi_color=True)
        self._feed = feed
        self.overview = Overview(bus, view, feed)

    def on_mount(self) -> None:
        self.push_screen(self.overview)
        loop = asyncio.get_running_loop()
        for number in ENDING:
            with suppress(ValueError, RuntimeError, NotImplementedError):  # not the main thread
                loop.add_signal_handler(number, self.exit, BY_SIGNAL + number)

    def on_ready(self) -> None:
        gc.freeze()  # collecting garbage among all imported objects takes 50 ms

    async def on_event(self, event: Event) -> None:
        # drop keys that arrive while the screens close
        if self.screen_stack or not isinstance(event, InputEvent):
            await super().on_event(event)

    def action_explain(self) -> None:
        if not isinstance(self.screen, HelpScreen):
            self.push_screen(HelpScreen())

    def action_clear(self) -> None:
        self._feed.clear()

    def action_leave(self) -> None:
        self.exit(0)

    def action_interrupt(self) -> None:
        self.exit(INTERRUPTED)

    def action_suspend(self) -> None:
        """Suspend the app until "fg", unless there is no shell to resume it."""
        if os.getpgrp() != os.getsid(0):
            self.action_suspend_process()


def show(monitor: BusMonitor, selection: ChannelSelection, view: TableView) -> int:
    """Show the live view until the user quits, and return the exit code."""
    feed = Feed(monitor, selection, _PERIOD)
    app = SpyApp(str(monitor.url), feed, view)
    feed.start()
    try:
        code = app.run()
    finally:
        feed.stop()
    return app.return_code or 0 if code is None else code
