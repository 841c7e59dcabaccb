"""Reports of rates, bandwidths and delays: as text, in the words of rostopic, and for JSON."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from lcmtools.observe.measuring.rates import Bandwidth, Statistics
from lcmtools.text_table import text_table

_KILO = 1e3
_SMALL = 1e-3  # [s], below which a delay is in microseconds
_SPREAD = "\n\tmin: {:.3f}s max: {:.3f}s std dev: {:.5f}s window: {}"


@dataclass(frozen=True, slots=True)
class ReportForm:
    """The form of measured values by topic; None stands for a topic with nothing new."""

    keys: Sequence[str]  # of the fields in JSON
    columns: Sequence[str]  # of the table, after the topic
    text: str  # a format for the fields, as lines of rostopic
    cells: Callable[[Any], list[str]]
    fields: Callable[[Any], Sequence[object]] = tuple  # the values that ``text`` formats
    nothing: str = "no new messages"

    def to_json(self, topic: str, value: Any) -> dict[str, object]:  # noqa: ANN401 - of ``cells``
        """Return a topic's measurement for JSON."""
        pairs = zip(self.keys, value, strict=True) if value else [(self.keys[0], None)]
        return {"topic": topic, **dict(pairs)}

    def to_lines(self, found: Mapping[str, Any]) -> list[str]:
        """Return the lines of one topic, or the table of several."""
        if not any(found.values()):
            return [self.nothing] * bool(self.nothing)
        if len(found) == 1:
            return [
                r for v in found.values() for r in self.text.format(*self.fields(v)).split("\n")
            ]
        rows = [[topic, *(self.cells(one) if one else "-----")] for topic, one in found.items()]
        return [*text_table(rows, ("topic", *self.columns)), ""]


def _seconds(value: Statistics) -> list[str]:
    numbers = (value.mean, value.shortest, value.longest, value.deviation)
    return [*(f"{number:.4}" for number in numbers), str(value.window)]


def _delays(value: Statistics) -> list[str]:
    """Average, shortest, longest and deviation in seconds, or in microseconds if all are small."""
    numbers = (value.mean, value.shortest, value.longest, value.deviation)
    if max(map(abs, numbers)) < _SMALL:
        first, *others = (f"{number * 1e6:.0f}" for number in numbers)
        return [f"{first} us", *(f"{other}us" for other in others), str(value.window)]
    mean, low, high, deviation = numbers
    texts = (f"{mean:.3f}", f"{low:.3f}s", f"{high:.3f}s", f"{deviation:.5f}s")
    return [*texts, str(value.window)]


def _bytes(value: Bandwidth) -> list[str]:
    """Average, mean, smallest and largest, all in the average's unit."""
    sizes = ((1.0, "B"), (_KILO, "KB"), (_KILO**2, "MB"))
    factor, unit = sizes[(value.average >= _KILO) + (value.average >= _KILO**2)]
    numbers = (value.average, value.mean, value.smallest, value.largest)
    average, *others = [f"{number / factor:.2f}{unit}" for number in numbers]
    return [f"{average}/s", *others, str(value.window)]


def _statistics_form(name: str, of: str) -> ReportForm:
    return ReportForm(
        (name, "min", "max", "std_dev", "window"),
        (name, f"min_{of}", f"max_{of}", "std_dev", "window"),
        f"average {name}: {{:.3f}}{_SPREAD}",
        _seconds,
    )


RATE = _statistics_form("rate", "delta")
DELAY = replace(
    _statistics_form("delay", "delay"),
    text="average delay: {}\n\tmin: {} max: {} std dev: {} window: {}",
    fields=_delays,
)
BANDWIDTH = ReportForm(
    ("bytes_per_second", "mean_bytes", "min_bytes", "max_bytes", "window"),
    ("average", "mean", "min", "max", "window"),
    "average: {}\n\tmean: {} min: {} max: {} window: {}",
    _bytes,
    _bytes,
    nothing="",
)
