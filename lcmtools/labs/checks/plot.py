"""The picture of a check: velocities over time, and the path on the map of the world."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.observations import Observations
from lcmtools.labs.checks.results import Report
from lcmtools.observe.measuring.curves import Curve, draw_curves, empty_figure, write_figure

if TYPE_CHECKING:  # a check without a picture does without matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure

_SIZE = 13, 4  # [inches] of each program's row
_SHAPE, _DESIRED, _MEASURED, _START = "#bfaf96", "tab:red", "tab:blue", "tab:green"
_BREAK = 0.5  # [m] a longer way between two samples is a robot that was put elsewhere
_SHAPES = ("box", "table", "cylinder", "sphere")
_QUANTITIES = ("forward speed [m/s]", "turn rate [rad/s]")
_Point = tuple[float, float]


def draw_check(world: Mapping[str, Any], reports: Sequence[Report], path: Path) -> None:
    """Write a picture with a row for each program: forward speed, turn rate, and the path.

    Raises:
        MissingExtra: matplotlib is missing.
        UsageError: The file's suffix is not one of a picture.
        LcmtoolsError: The file cannot be written.
    """
    drawn = [(report, seen) for report in reports if (seen := report.observations)]
    width, height = _SIZE
    figure = empty_figure(width, height * max(1, len(drawn)))
    rows = figure.subfigures(max(1, len(drawn)), squeeze=False)[:, 0]
    for row, (report, observed) in zip(rows, drawn, strict=False):
        row.suptitle(
            f"{report.program}: {report.passed} of {len(report.results)} are as the lab specifies"
        )
        _draw_program(row, world, observed)
    write_figure(figure, path)


def velocity_curves(observed: Observations, index: int) -> list[Curve]:
    """Return the desired and the measured values over time: 0 is forward speed, 1 turn rate.

    Desired is what the check desired of the program, else what the program commanded.
    """
    desired = [
        (desire.time, (desire.forward, desire.turn_rate)[index]) for desire in observed.desired
    ]
    commanded = [
        (command.time, velocity[index])
        for command in observed.commands
        if (velocity := velocity_of(command.message))
    ]
    steps = desired or commanded
    end = observed.motion[-1].time if observed.motion else 0.0
    first = Curve("desired" if desired else "commanded")
    for (time, value), (after, _) in pairwise([*steps, (end, 0.0)]):
        first.times += [time, after]
        first.values += [value, value]
    measured = [(state.forward, state.turn_rate)[index] for state in observed.motion]
    return [first, Curve("measured", [state.time for state in observed.motion], measured)]


def _draw_program(row: "SubFigure", world: Mapping[str, Any], observed: Observations) -> None:
    charts = row.add_gridspec(2, 2)
    for index, quantity in enumerate(_QUANTITIES):
        axes = row.add_subplot(charts[index, 0], ylabel=quantity)
        axes.axhline(0.0, color="lightgrey")  # so that small changes of a high speed look small
        axes.set_prop_cycle(color=[_DESIRED, _MEASURED])
        draw_curves(axes, velocity_curves(observed, index))
    _draw_map(
        row.add_subplot(charts[:, 1], title="driven path, x to the right [m]"), world, observed
    )


def _draw_map(axes: "Axes", world: Mapping[str, Any], observed: Observations) -> None:
    axes.set_aspect("equal", adjustable="datalim")
    for is_open, outline in (
        shape for thing in world.get("objects", ()) for shape in _outlines(thing)
    ):
        x, y = zip(*outline, strict=True)
        axes.plot(x, y, color=_SHAPE) if is_open else axes.fill(x, y, color=_SHAPE)
    if observed.path:
        axes.plot(*zip(*observed.path, strict=True), color=_DESIRED, linewidth=3)
    pieces = [*_pieces([(state.x, state.y) for state in observed.motion])]
    for piece in pieces:
        axes.plot(*zip(*piece, strict=True), color=_MEASURED)
    for piece in pieces[:1]:
        axes.plot(*piece[0], color=_START, marker="o")
    for touch in observed.touches[:1]:
        axes.annotate(f"touches {touch.body}", (touch.x, touch.y), color=_DESIRED)


def _pieces(path: Sequence[_Point]) -> Iterator[list[_Point]]:
    """Return the parts of a path between the places where the robot was put elsewhere."""
    piece: list[_Point] = []
    for point in path:
        if piece and math.dist(piece[-1], point) > _BREAK:
            yield piece
            piece = []
        piece.append(point)
    if piece:
        yield piece


def _outlines(thing: Mapping[str, Any]) -> Iterator[tuple[bool, list[_Point]]]:
    """Return the outlines of an object of a world file, each with True if it is a line."""
    if points := thing.get("points"):
        outline = [(float(x), float(y)) for x, y, *_ in points]
        yield True, [*outline, outline[0]] if thing.get("closed") else outline
    if thing.get("type") not in _SHAPES or len(thing.get("pose", ())) < 2:  # noqa: PLR2004 - x, y
        return
    x, y, *rest = thing["pose"]
    yaw = _angle(rest[-1]) if rest else 0.0
    radius = thing.get("radius")
    if radius is not None:
        angles = [math.tau * step / 24 for step in range(24)]
        corners = [(radius * math.cos(a), radius * math.sin(a)) for a in angles]
    else:
        length, width, *_ = thing["size"]
        corners = [(a * length / 2, b * width / 2) for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    cos, sin = math.cos(yaw), math.sin(yaw)
    yield False, [(x + a * cos - b * sin, y + a * sin + b * cos) for a, b in corners]


def _angle(value: object) -> float:
    """Return an angle of a world file [rad]: a number, or "90 deg"."""
    text = str(value)
    number = float(text.removesuffix("deg"))
    return math.radians(number) if text.endswith("deg") else number
