"""Channels as the lines of a table and as values for JSON."""

from collections.abc import Sequence

from lcmtools.observe.channels.columns import COLUMNS
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.channels.table import layout, natural_widths

_LATEST = ("age",)  # columns without meaning in a table that is not updated


def to_lines(channels: Sequence[ChannelRow], room: int | None) -> list[str]:
    """Return the lines of the table, ``room`` characters wide; None for any width."""
    columns = [column for name, column in COLUMNS.items() if name not in _LATEST]
    found = layout(columns, natural_widths(channels, columns), room)
    cells = [found.row(), *map(found.row, channels)]
    return [found.gap.join(line).rstrip() for line in cells]


def to_json(row: ChannelRow) -> dict[str, object]:
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
