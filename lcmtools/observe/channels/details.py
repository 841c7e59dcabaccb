"""One channel as text: its properties, and the lines of its message with their curves."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from lcmtools.graph.drawing.labels import printable
from lcmtools.names import is_of_lcm
from lcmtools.observe.channels.columns import (
    age_text,
    bandwidth_text,
    jitter_text,
    loss_text,
    names_text,
    rate_text,
)
from lcmtools.observe.channels.field_lines import FieldLine
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.channels.study import ChannelState, Sample, Sparkline, curve
from lcmtools.observe.reports.describe import NO_TYPE, size_text

BIN_NS = 500_000_000  # the time that one bar of a curve spans [ns]
BARS = 40  # the greatest number of bars

_INDENT = "  "
_HEX = 16  # bytes in a line


class DetailLine(NamedTuple):
    """A line of a message, or of bytes that cannot be decoded.

    ``bars`` and ``span`` are the curve of a number and its range; empty for anything else.
    """

    key: str
    name: str
    value: str
    bars: tuple[float, ...] = ()
    span: str = ""
    is_number: bool = False


def flow_text(row: ChannelRow) -> str:
    """Rate, jitter, bandwidth, loss and number of messages."""
    lost = f" of its senders' messages ({row.lost})" if row.lost else ""
    return (
        f"{rate_text(row.rate)} Hz  jitter {jitter_text(row.jitter)}"
        f"  {bandwidth_text(row.bandwidth)}  loss {loss_text(row.loss)}{lost}"
        f"  {row.messages} messages"
    )


def properties(row: ChannelRow, state: ChannelState) -> Iterator[tuple[str, str]]:
    """The labels and texts of what is known of a channel."""
    yield "type", _type_text(row, state)
    if state.fingerprint is not None:
        yield "fingerprint", f"{state.fingerprint:#018x}"
    yield "senders", printable(names_text(row.senders))
    yield "listeners", printable(names_text(row.listeners))
    yield "message", _message_text(row, state)


def detail_lines(
    state: ChannelState, samples: Callable[[str], Sequence[Sample]]
) -> list[DetailLine]:
    """The lines of the latest message, with the curves of its numbers."""
    if state.problem:
        return list(_byte_lines(state.head))
    return [_field_line(line, state.time, samples) for line in state.lines]


def number_text(value: float) -> str:
    """A number in at most eleven characters."""
    return f"{value:.0f}" if value.is_integer() and abs(value) < 1e10 else f"{value:.5g}"  # noqa: PLR2004


def _byte_lines(head: bytes) -> Iterator[DetailLine]:
    for start in range(0, len(head), _HEX):
        part = head[start : start + _HEX]
        text = "".join(chr(byte) if 32 <= byte < 127 else "." for byte in part)  # noqa: PLR2004
        yield DetailLine(f"{start}", f"{start:6}", f"{part.hex(' '):<{3 * _HEX}} {text}")


def _field_line(
    line: FieldLine, now: int, samples: Callable[[str], Sequence[Sample]]
) -> DetailLine:
    mark = ("▾ " if line.is_open else "▸ ") if line.opens else "  "
    name = f"{_INDENT * line.depth}{mark}{line.label}"
    if line.number is None:
        return DetailLine(line.path, name, printable(line.text))
    found = curve(samples(line.path), now, BARS, BIN_NS)
    return DetailLine(line.path, name, line.text, found.bars, _span_text(found), is_number=True)


def _span_text(found: Sparkline) -> str:
    if not found.bars or found.low == found.high:
        return "constant" if found.bars else ""
    first, last = number_text(found.low), number_text(found.high)
    is_narrow = first == last
    return f"{first}, within {found.high - found.low:.2g}" if is_narrow else f"{first} .. {last}"


def _type_text(row: ChannelRow, state: ChannelState) -> str:
    unknown = NO_TYPE if is_of_lcm(row.channel) else "unknown"
    name = state.type or ", ".join(row.types) or unknown
    if name in row.types and row.is_announced:
        return f"{name}, as announced"
    others = state.others if state.type else ()
    return f"{name} by its fingerprint, or {' or '.join(others)}" if others else name


def _message_text(row: ChannelRow, state: ChannelState) -> str:
    if not state.time:
        return "none since this view was opened"
    text = f"{size_text(state.size)}, {age_text(row.age)} ago"
    if state.messages > state.decoded and not state.problem:
        text += f"; {state.decoded} of {state.messages} were decoded, for the curves"
    return text
