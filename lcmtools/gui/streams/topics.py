"""The stream of the topics: for each the record of ``spy --json``, and if it is silent.

Listeners are null where only programs receive that announce nothing.
"""

from typing import cast

from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.observe.channels.channel_report import to_json
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.simulators import simulators


def newest_simulator(latest: Snapshot) -> int:
    """Return when the newest simulator was started [ns since 1970]; 0 without one."""
    return max((one.start_time for one in simulators(latest.graph)), default=0)


def current_rows(latest: Snapshot) -> list[ChannelRow]:
    """Return all topics but those that were left by a simulator before the present one."""
    began, graph = newest_simulator(latest), latest.graph
    return [
        row
        for row in latest.rows
        if row.age is None
        or not began
        or graph.time - row.age * 1e9 > began
        or row.listeners
        or any(not node.stale for node, _ in graph.topic(row.channel).publishers)
    ]


class Topics(PageStream):
    """All topics of the source except hidden ones."""

    period = 0.25
    is_shared = True

    def __init__(self, source: Source) -> None:
        super().__init__(source)
        self.until_closed(source.listen_to_all())

    def update(self) -> Update:
        """Return the current rows."""
        latest = self.source.latest
        programs = latest.plain_listeners  # which may listen to any of them
        rows = [{**to_json(row), "silent": row.is_silent} for row in current_rows(latest)]
        if programs:
            rows = [{**row, "listeners": row["listeners"] or None} for row in rows]
        data: dict[str, Json] = {
            "rows": cast("Json", rows),
            "programs": programs,
            "errors": latest.callback_errors,
        }
        return Update(data)

    def problem(self) -> str:
        """Return a sentence if there are no topics yet."""
        return "" if self.source.latest.rows else "there are no topics on the bus"
