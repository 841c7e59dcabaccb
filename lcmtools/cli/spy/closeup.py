"""One channel as lines of text: who sends and hears it, and its message with curves.

A line is made of pieces, each with the name of how it looks: "", name, curve, dim, bold, warn.
"""

from collections.abc import Callable, Sequence

from lcmtools.cli.spy.columns import (
    age_text,
    bandwidth_text,
    cut,
    jitter_text,
    loss_text,
    names_text,
    printable,
    rate_text,
    size_text,
    width_of,
)
from lcmtools.cli.spy.numbers import Line
from lcmtools.cli.spy.sparkline import Sample, number_text, sparkline
from lcmtools.observe.channels import Row
from lcmtools.observe.study import Look

Pieces = list[tuple[str, str]]

BIN_NS = 500_000_000
"""The time that a bar of a curve stands for [ns]."""

_INDENT = "  "
_HEX = 16  # bytes in a line
_LABEL = 12  # characters that what is said of a channel begins after
_CURVES = (10, 40)  # bars at least and at most
_RANGE = 25  # characters of "min .. max"
_VALUE = 24  # characters of a number


class Closeup:
    """One channel at one time.

    Args:
        row: What the table knows of it.
        look: What is known of its messages.
    """

    def __init__(self, row: Row, look: Look) -> None:
        self._row = row
        self._look = look
        self._lines = {line.path: line for line in look.lines}
        self._shown = list(self._lines.values())
        self._names = max((self._name_width(line) for line in self._shown), default=0)

    @property
    def keys(self) -> list[str]:
        """What each line of the message is about."""
        if self._look.problem:
            head = self._look.head
            return [f"{start}" for start in range(0, len(head), _HEX)]
        return list(self._lines)

    def line(self, key: str) -> Line | None:
        """A line of the message."""
        return self._lines.get(key)

    def head(self, width: int) -> list[Pieces]:
        """What is known of the channel, a line each."""
        row, look = self._row, self._look
        flow = [f"{rate_text(row.rate)} Hz", f"jitter {jitter_text(row.jitter)}"]
        flow += [bandwidth_text(row.bandwidth), f"loss {self._loss()}"]
        flow += [f"{row.messages} messages"]
        said: list[tuple[str, str]] = [("type", self._type())]
        if look.fingerprint is not None:
            said.append(("fingerprint", f"{look.fingerprint:#018x}"))
        said += [("senders", names_text(row.senders)), ("listeners", names_text(row.listeners))]
        said.append(("message", self._message()))
        lines: list[Pieces] = [[(printable(row.channel), "bold"), (f"  {'  '.join(flow)}", "")]]
        for label, text in said:
            shown = cut(printable(text), width - _LABEL, "end")
            lines.append([(f"{label:<{_LABEL}}", "dim"), (shown, "")])
        if look.problem:
            lines.append([(cut(printable(look.problem), width, "end"), "warn")])
        return lines

    def body(self, number: int, width: int, samples: Callable[[str], Sequence[Sample]]) -> Pieces:
        """A line of the message, or of the bytes that it could not be made of.

        Args:
            number: Which line.
            width: Characters of it.
            samples: Gives what a number has been.
        """
        if self._look.problem:
            return self._bytes(number * _HEX)
        line = self._shown[number]
        names = min(self._names, width // 2)
        mark = ("▾ " if line.is_open else "▸ ") if line.opens else "  "
        name = cut(f"{_INDENT * line.depth}{mark}{line.label}", names, "end")
        pieces = [(name + " " * (names - width_of(name)) + "  ", "name")]
        if line.number is None:
            return [*pieces, (printable(line.text), "")]
        return [*pieces, *self._curve(line, width - names - 2, samples(line.path))]

    def _curve(self, line: Line, room: int, samples: Sequence[Sample]) -> Pieces:
        """A number, its curve, and from where to where it goes."""
        value = f"{cut(line.text, _VALUE, 'end'):>{_VALUE}}  "
        bars = min(_CURVES[1], room - width_of(value) - _RANGE - 2)
        samples = [(time, number) for time, number in samples if time <= self._look.time]
        if bars < _CURVES[0] or not samples:
            return [(value, "")]
        known = [number for time, number in samples if time > self._look.time - bars * BIN_NS]
        low, high = min(known, default=0.0), max(known, default=0.0)
        said = _span_text(low, high)
        curve = sparkline(samples, self._look.time, bars, BIN_NS)
        return [(value, ""), (curve, "curve"), (f"  {said}", "dim")]

    def _bytes(self, start: int) -> Pieces:
        part = self._look.head[start : start + _HEX]
        text = "".join(chr(byte) if 32 <= byte < 127 else "." for byte in part)  # noqa: PLR2004
        return [(f"{start:6}  ", "dim"), (f"{part.hex(' '):<{3 * _HEX}} ", ""), (text, "name")]

    def _loss(self) -> str:
        row = self._row
        text = loss_text(row.loss)
        return f"{text} of its senders' messages ({row.lost})" if row.lost else text

    def _type(self) -> str:
        row, look = self._row, self._look
        name = look.type or ", ".join(row.types) or "unknown"
        if name in row.types and row.is_announced:
            return f"{name}, as announced"
        others = look.others if look.type else ()
        return f"{name} by its fingerprint, or {' or '.join(others)}" if others else name

    def _message(self) -> str:
        look = self._look
        if not look.size and not look.time:
            return "none since it is looked at closely"
        said = f"{size_text(look.size)}, {age_text(self._row.age)} ago"
        passed = look.messages - look.decoded
        if passed and not look.problem:
            said += f"; of {look.messages} that came {look.decoded} were decoded, for the curves"
        return said

    @staticmethod
    def _name_width(line: Line) -> int:
        return len(_INDENT) * line.depth + 2 + width_of(line.label)


def _span_text(low: float, high: float) -> str:
    """From where to where a number goes."""
    if low == high:
        return "constant"
    first, last = number_text(low), number_text(high)
    return f"{first} .. {last}" if first != last else f"{first}, within {high - low:.2g}"
