"""Values of fields over time, as curves, drawn as a picture or as text for a terminal."""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, cast

from lcmtools.clock import join_stamp
from lcmtools.errors import DecodeError, UsageError, needing_extra
from lcmtools.escapes import ESCAPES
from lcmtools.folders import write_whole
from lcmtools.messages.fields import is_time, visible_fields
from lcmtools.messages.layout import is_generated
from lcmtools.messages.path import Path, select
from lcmtools.messages.registry import Message
from lcmtools.messages.shape import as_sequence
from lcmtools.names import Resolver
from lcmtools.observe.reading.arrivals import ArrivalStream, SelectedPacket, taken
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.selection import select_topics

if TYPE_CHECKING:  # only pictures need matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")  # the endings of pictures
_MARGIN = 0.08  # of the values' span, above and below
_LEAST_SPAN = 1e-5  # a smaller span is noise
_RESOLUTION = 1e-8  # of the values' size: so is this
_MOST_CURVES = 20  # from one path: more cannot be told apart
_HINT = "name a field of numbers"


@dataclass(slots=True)
class Curve:
    """The times [s since 1970 or since the start of the simulation] and values of a field."""

    label: str  # "/husky0/odometry/twist.twist.linear.x"
    times: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)

    def drop_before(self, time: float) -> None:
        """Forget values older than ``time`` [s], or all if simulated time has gone back."""
        if self.times[-1] < self.times[0]:
            del self.times[:-1], self.values[:-1]
        old = next((n for n, one in enumerate(self.times) if one >= time), len(self.times))
        del self.times[:old], self.values[:old]


class Curves:
    """The curves of fields, given as topics followed by field paths, on a bus or in a log.

    ``notify`` is called with a sentence if something is left out, once for each reason, and if it
    takes long. Only the last ``window`` seconds are kept, or all.

    Raises:
        UsageError: A path is wrong.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        fields: Iterable[str],
        names: Resolver,
        notify: Callable[[str], None],
        window: float | None = None,
    ) -> None:
        monitor.discover()
        selections = [select_topics(one, names) for one in fields]
        self._stream = ArrivalStream(
            monitor, selections, names, wall_time=not monitor.is_live, strict_time=True
        )
        self._decoder, self._notify, self._window = Decoder(monitor.types_of), notify, window
        self._notified: set[str] = set()
        self._curves: dict[str, Curve] = {}

    def __iter__(self) -> Iterator[Curve]:
        """Return the curves, in order of appearance."""
        return iter(self._curves.values())

    def follow(
        self, period: float = math.inf, timeout: float | None = None, duration: float | None = None
    ) -> Iterator[None]:
        """Receive messages, and yield every ``period`` [s], until the log or ``duration`` [s] ends.

        Raises:
            UsageError: The selected field is not a number.
            ValueMismatch: A message has no such field or element.
            NothingReceived: No message came for ``timeout`` [s].
            LcmtoolsError: The log has no message on the topics.
        """
        start = due = time.monotonic()
        for _ in taken(self._stream, self._add, timeout, self._notify):
            now = time.monotonic()
            if now >= due and math.isfinite(period):
                due = now + period
                yield
            if duration is not None and now - start >= duration:
                return

    def _add(self, found: SelectedPacket) -> bool | None:
        """Add the numbers of a message; return None for one that cannot be decoded."""
        try:
            message = self._decoder.decode(found.packet)
        except DecodeError as error:
            text = f"messages on {found.packet.channel} are left out: {error}"
            if text not in self._notified:
                self._notified.add(text)
                self._notify(text)
            return None
        moment = found.time / 1e9
        for path, value in numbers(message, found.path):
            label = f"{found.packet.channel}/{path}" if path else found.packet.channel
            curve = self._curves.get(label)
            if curve is None:
                curve = self._curves[label] = Curve(label)
            curve.times.append(moment)
            curve.values.append(value)
            if self._window is not None:
                curve.drop_before(moment - self._window)
        return True


def numbers(message: Message, path: Path) -> list[tuple[str, float]]:
    """Return the numbers that a path selects, with the path of each.

    Raises:
        UsageError: There is no number, or more than can be told apart.
        ValueMismatch: The message has no such field or element.
    """
    selected = select(message, path)
    found = list(_of_value(selected.value, selected.target.type, str(path)))
    where = str(path) or "the message"
    if not found:
        raise UsageError(f"{where} has no number", _HINT)
    if len(found) > _MOST_CURVES:
        raise UsageError(f"{where} has {len(found)} numbers", f"name some: {found[0][0]}")
    return found


def _of_value(value: object, kind: str, path: str) -> Iterator[tuple[str, float]]:
    """The numbers in a value: itself, or those of its elements or fields."""
    if isinstance(value, (bool, int, float)):
        yield path, float(value)
    elif isinstance(value, str):
        raise UsageError(f"{path} is a {kind}, not a number", _HINT)
    elif is_generated(type(value)):
        yield from _of_message(cast("Message", value), path)
    else:
        for index, element in enumerate(as_sequence(value)):
            yield from _of_value(element, kind, f"{path}[{index}]")


def _of_message(message: Message, path: str) -> Iterator[tuple[str, float]]:
    cls = type(message)
    if is_time(cls):
        yield path, join_stamp(*(int(getattr(message, name)) for name in cls.__slots__)) / 1e9
        return
    for part in visible_fields(cls):
        if part.type != "string":
            inner = f"{path}.{part.name}" if path else part.name
            yield from _of_value(getattr(message, part.attribute), part.type, inner)


def _common_start(curves: Sequence[Curve]) -> float:
    """Return the first time of all curves [s]; 0 without values."""
    return min((curve.times[0] for curve in curves if curve.times), default=0.0)


def value_limits(least: float, most: float, margin: float = _MARGIN) -> tuple[float, float]:
    """Return the limits of the value axis: the values with a margin, or equal ones in the middle.

    Values count as equal if they differ only by noise. Not finite ones are those of no value. The
    window has the same rule in ``plot/limits.js``.
    """
    size = max(abs(least), abs(most))
    if size == 0 or not math.isfinite(size):
        return -1.0, 1.0
    span = most - least
    if span >= max(_LEAST_SPAN, _RESOLUTION * size):
        return least - margin * span, most + margin * span
    middle, more = least + span / 2, max(0.1 * size, _LEAST_SPAN)
    return middle - more, middle + more


def check_suffix(path: FilePath) -> None:
    """Check that a file's suffix is one of a picture.

    Raises:
        UsageError: It is another one.
    """
    if path.suffix not in PICTURES:
        raise UsageError(f"{path} is not a picture", f"use a suffix ({', '.join(PICTURES)})")


def empty_figure(width: float, height: float) -> "Figure":
    """Return a figure of this size [inches] to draw curves in.

    Raises:
        MissingExtra: matplotlib is missing.
    """
    with needing_extra("plot", "pictures of curves need"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw_curves(axes: "Axes", curves: Sequence[Curve], start: float | None = None) -> None:
    """Draw curves over seconds since ``start``, or since their first value."""
    start = _common_start(curves) if start is None else start
    for curve in curves:
        axes.plot([time - start for time in curve.times], curve.values, label=curve.label)
    axes.set_xlabel("time [s]")
    axes.set_ylim(*value_limits(*axes.dataLim.intervaly))
    axes.grid(visible=True, alpha=0.3)
    axes.legend(loc="best")


def write_figure(figure: "Figure", path: FilePath) -> None:
    """Write a figure into a file: PNG, SVG or PDF, by its suffix.

    Raises:
        UsageError: The suffix is another one.
        LcmtoolsError: The file cannot be written.
    """
    check_suffix(path)
    picture = BytesIO()
    figure.savefig(picture, dpi=120, format=path.suffix[1:])
    write_whole(path, picture.getvalue())


def draw_picture(curves: Sequence[Curve], path: FilePath) -> None:
    """Draw curves into a picture.

    Raises:
        MissingExtra: matplotlib is missing.
        UsageError: The file's suffix is not one of a picture.
        LcmtoolsError: The file cannot be written.
    """
    check_suffix(path)
    figure = empty_figure(10, 5)
    draw_curves(figure.add_subplot(), curves)
    write_figure(figure, path)


def draw_text(curves: Sequence[Curve], width: int, height: int, *, colored: bool) -> str:
    """Return curves as text of this size, over seconds since their first value.

    Raises:
        MissingExtra: plotext is missing.
    """
    with needing_extra("plot", "curves in a terminal need"):
        import plotext
    plotext.clear_figure()
    plotext.theme("pro" if colored else "clear")
    plotext.plotsize(width, height)
    start, shown = _common_start(curves), list[float]()
    for curve in curves:
        finite = [n for n, value in enumerate(curve.values) if math.isfinite(value)]
        times = [curve.times[n] - start for n in finite]
        if finite:
            values = [curve.values[n] for n in finite]
            label = curve.label.translate(ESCAPES)
            plotext.plot(times, values, label=label, marker="braille")
            shown += (min(values), max(values))
    if shown:
        plotext.ylim(*value_limits(min(shown), max(shown), margin=0.0))
    plotext.xlabel("time [s]")
    text = str(plotext.build())
    return text if colored else str(plotext.uncolorize(text))
