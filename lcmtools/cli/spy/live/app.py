"""The live view: a table, one channel closely, a number over time, and the way out."""

import asyncio
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from typing import ClassVar, Protocol

from textual.app import App
from textual.binding import Binding, BindingType

from lcmtools.cli.ending import BY_SIGNAL, INTERRUPTED
from lcmtools.cli.spy.live.curve import CurveScreen
from lcmtools.cli.spy.live.detail import Detail
from lcmtools.cli.spy.live.overview import Overview
from lcmtools.cli.spy.live.sorting import HelpScreen
from lcmtools.cli.spy.view import View
from lcmtools.observe.channels import Wanted
from lcmtools.observe.feed import Feed, Snapshot
from lcmtools.observe.follower import Follower
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.study import Study

_PERIOD = 0.2  # [s] between two looks at what is new


class Source(Protocol):
    """Where what is shown comes from."""

    @property
    def latest(self) -> Snapshot:
        """What is known of the bus; another object when that is new."""
        ...

    def clear(self) -> None:
        """Count everything anew."""
        ...


Follow = Callable[[Study], Callable[[], None]]
"""Has a study hear its channel's messages; gives what ends that."""


class SpyApp(App[int]):
    """The live view.

    Args:
        bus: The bus's URL.
        source: What is known of the bus.
        follow: What has a channel looked at closely.
        view: How the table is looked at.
    """

    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Overview, Detail, CurveScreen {
        background: ansi_default; color: ansi_default; overflow: hidden;
    }
    Lines { height: 1fr; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f10", "leave", show=False, priority=True),
        Binding("ctrl+q", "leave", show=False, priority=True),
        Binding("ctrl+c", "interrupt", show=False, priority=True),
        Binding("ctrl+z", "suspend", show=False, priority=True),
        Binding("f1,h,question_mark", "explain", show=False),
    ]

    def __init__(self, bus: str, source: Source, follow: Follow, view: View) -> None:
        super().__init__(ansi_color=True)
        self.overview = Overview(bus, view, self.look_closely)
        self._source = source
        self._follow = follow
        self._shown: Snapshot | None = None

    def on_mount(self) -> None:
        """Show the table, and look for what is new from now on."""
        self.push_screen(self.overview)
        self.set_interval(_PERIOD, self._tick)
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with suppress(ValueError, RuntimeError, NotImplementedError):  # not the main thread
                loop.add_signal_handler(number, self.exit, BY_SIGNAL + number)

    def look_closely(self, channel: str) -> None:
        """Show a channel closely."""
        row = self._source.latest.row(channel)
        study = Study(row.channel, row.types if row.is_announced else ())
        self.push_screen(Detail(study, row, self._follow(study)))

    def action_explain(self) -> None:
        """Show the keys."""
        if not isinstance(self.screen, HelpScreen):
            self.push_screen(HelpScreen())

    def action_clear(self) -> None:
        """Count everything anew."""
        self._source.clear()

    def action_leave(self) -> None:
        """End: all was seen."""
        self.exit(0)

    def action_interrupt(self) -> None:
        """End, as by Ctrl-C."""
        self.exit(INTERRUPTED)

    def action_suspend(self) -> None:
        """Give the terminal back until "fg"; not where no shell could say that."""
        if os.getpgrp() != os.getsid(0):
            self.action_suspend_process()

    def _tick(self) -> None:
        snapshot = self._source.latest
        screen = self.screen_stack[-1] if self.screen_stack else None  # none at the end
        is_new = snapshot is not self._shown
        self._shown = snapshot
        if is_new and not isinstance(screen, Detail):
            self.overview.take(snapshot)
        if isinstance(screen, Detail):
            screen.take(snapshot.row(screen.study.channel))
        elif isinstance(screen, CurveScreen):
            screen.take()


def show(monitor: BusMonitor, wanted: Wanted, view: View) -> int:
    """Show the live view until the person has had enough; the exit code.

    Args:
        monitor: The bus.
        wanted: Which channels have a row.
        view: How the table is looked at first.
    """
    feed = Feed(monitor, wanted)

    def follow(study: Study) -> Callable[[], None]:
        if feed.url.is_multicast:
            return Follower(feed.url, study.channel, study.hear).stop
        feed.follow = study.hear

        def stop() -> None:
            feed.follow = None

        return stop

    app = SpyApp(str(monitor.url), feed, follow, view)
    feed.start()
    try:
        code = app.run()
    finally:
        feed.stop()
    return app.return_code or 0 if code is None else code
