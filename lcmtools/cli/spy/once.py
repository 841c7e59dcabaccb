"""``lcmtools spy --once``: the table as text or JSON."""

from collections.abc import Sequence

from lcmtools.bus.url import BusUrl
from lcmtools.cli.spy.columns import COLUMNS, layout, natural_widths
from lcmtools.graph.model import Graph
from lcmtools.observe.activity import Activity
from lcmtools.observe.channels import Row, Rows, Wanted, losses
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.programs import programs
from lcmtools.observe.senders import SenderNames, program_name
from lcmtools.observe.settled import settled

_LATEST = ("age",)  # columns that say nothing in a table that does not go on


def look(monitor: BusMonitor, wanted: Wanted, wait: float) -> tuple[Graph, tuple[Row, ...]]:
    """The rows of a bus after listening for some seconds; of a log, of all that is in it.

    Raises:
        BusError: A log cannot be read.
    """
    rows = Rows(wanted, SenderNames())
    is_log = monitor.url.provider == "file"
    if not is_log:
        monitor.listen_to(rows.published(monitor.settle(foreign=False)))
    activity = Activity()
    graph = settled(monitor, wait, activity)
    tap = monitor.tap
    lost = losses(tap.numbered) if tap else None
    return graph, rows.make(graph, activity, lost, activity.last_time if is_log else graph.time)


def table(rows: Sequence[Row], room: int | None) -> list[str]:
    """The lines of the table.

    Args:
        rows: What is in it.
        room: Characters of a line; None for as many as it takes.
    """
    columns = [column for name, column in COLUMNS.items() if name not in _LATEST]
    found = layout(columns, natural_widths(rows, columns), room)
    cells = [found.header(), *map(found.row, rows)]
    return [found.gap.join(line).rstrip() for line in cells]


def record(row: Row) -> dict[str, object]:
    """A row for JSON."""
    return {
        "channel": row.channel,
        "types": list(row.types),
        "announced": row.is_announced,
        "fingerprints": [f"{value:#018x}" for value in row.fingerprints],
        "messages": row.messages,
        "bytes": row.bytes,
        "rate": row.rate,
        "jitter": row.jitter,
        "bandwidth": row.bandwidth,
        "senders": list(row.senders),
        "senders_lost": row.lost,
        "senders_loss": row.loss,
        "listeners": list(row.listeners),
        "age": row.age,
    }


def notes(rows: Sequence[Row], graph: Graph, url: BusUrl) -> list[str]:
    """What a table cannot say: whose the loss is, and who listens to nobody knows what."""
    said = []
    if any(row.lost for row in rows):
        said.append(
            "loss is of a channel's senders: LCM numbers a sender's messages, not channels'"
        )
    if found := plain_listeners(graph, url):
        said.append(f"{', '.join(found)}: listens too, as no node; on which channels does not show")
    return said


def plain_listeners(graph: Graph, url: BusUrl) -> list[str]:
    """The programs of this computer that receive from the bus and are no nodes."""
    if not url.is_multicast:
        return []
    return [
        f"{program_name(program.process.command)} (pid {program.process.pid})"
        for program in programs(graph, url)
        if program.listens and program.process
    ]
