"""A picture of a check: velocities over time, and the path on the map. Drawn by Pillow.

Pillow is there wherever the simulator is. For two kinds of lines and a map it does what matplotlib
would, without 40 MB more.
"""

import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from PIL import Image, ImageDraw

from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.observations import Observations
from lcmtools.labs.checks.results import Report

_WIDTH, _HEIGHT, _MARGIN, _GAP = 760, 420, 56, 28  # [pixels] of a chart or a map
_INK, _GRID, _SHAPE = (40, 40, 40), (215, 215, 215), (190, 175, 150)
_DESIRED, _MEASURED, _START = (214, 39, 40), (31, 119, 180), (44, 160, 44)
_TICKS = 6
_Points = Sequence[tuple[float, float]]
_BREAK = 0.5  # [m] a longer way between two samples is a robot that was put elsewhere
_SHAPES = ("box", "table", "cylinder", "sphere")


def plot(world: Mapping[str, Any], reports: Sequence[Report]) -> bytes:
    """Return a PNG file with a row for each program: forward speed, turn rate, and the path."""
    seen = [report for report in reports if report.observations]
    size = 2 * _WIDTH, max(1, len(seen)) * _HEIGHT
    image = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(image)
    for index, report in enumerate(seen):
        assert report.observations is not None
        top = index * _HEIGHT
        draw.text((_MARGIN, top + 6), f"{report.program}: {report.passed} of"
                  f" {len(report.results)} are as the lab specifies", _INK)  # fmt: skip
        _draw_velocities(draw, report.observations, top)
        _draw_map(draw, world, report.observations, top)
    file = io.BytesIO()
    image.save(file, "PNG")
    return file.getvalue()


def series(observed: Observations, index: int) -> tuple[_Points, _Points]:
    """Return the desired and the measured values over time: 0 is forward speed, 1 turn rate.

    Desired is what the check desired of the program, else what the program commanded.
    """
    wanted = [(one.time, (one.forward, one.turn_rate)[index]) for one in observed.desired] or [
        (command.time, velocity[index])
        for command in observed.commands
        if (velocity := velocity_of(command.message))
    ]
    end = observed.motion[-1].time if observed.motion else 0.0
    steps = [
        point
        for (time, value), (after, _) in pairwise([*wanted, (end, 0.0)])
        for point in ((time, value), (after, value))
    ]
    measured = [(s.time, (s.forward, s.turn_rate)[index]) for s in observed.motion]
    return steps, measured


def _draw_velocities(draw: ImageDraw.ImageDraw, observed: Observations, top: int) -> None:
    height = (_HEIGHT - _GAP) // 2
    for index, title in enumerate(("forward speed [m/s]", "turn rate [rad/s]")):
        desired, measured = series(observed, index)
        box = (
            _MARGIN,
            top + _GAP + index * height,
            _WIDTH - _GAP,
            top + _GAP + (index + 1) * height,
        )
        inner = (box[0], box[1] + 14, box[2], box[3] - 18)
        draw.text((box[0], box[1]), title, _INK)
        name = "desired" if observed.desired else "commanded"
        draw.text((box[2] - 170, box[1]), name, _DESIRED)
        draw.text((box[2] - 90, box[1]), "measured", _MEASURED)
        place = _axes(draw, inner, [*desired, *measured])
        for points, color in ((measured, _MEASURED), (desired, _DESIRED)):
            if len(points) > 1:
                draw.line([place(*point) for point in points], color, 2)


def _axes(
    draw: ImageDraw.ImageDraw, box: tuple[int, int, int, int], points: _Points
) -> Callable[[float, float], tuple[float, float]]:
    """Draw the axes of a chart; return the place of a point in it."""
    left, top, right, bottom = box
    low_x, high_x = _range([x for x, _ in points], 1.0)
    low_y, high_y = _range([y for _, y in points], 0.1)

    def place(x: float, y: float) -> tuple[float, float]:
        across = (x - low_x) / (high_x - low_x)
        up = (y - low_y) / (high_y - low_y)
        return left + across * (right - left), bottom - up * (bottom - top)

    for value in _ticks(low_x, high_x):
        x, _ = place(value, low_y)
        draw.line((x, top, x, bottom), _GRID)
        draw.text((x, bottom + 2), f"{value:g} s", _INK, anchor="ma")
    for value in _ticks(low_y, high_y):
        _, y = place(low_x, value)
        draw.line((left, y, right, y), _GRID)
        draw.text((left - 4, y), f"{value:g}", _INK, anchor="rm")
    return place


def _range(values: Sequence[float], least: float) -> tuple[float, float]:
    """Return the ends of an axis that shows the finite ones of some values, and 0."""
    known = [0.0, *(value for value in values if math.isfinite(value))]
    low, high = min(known), max(known)
    room = max((high - low) * 0.08, least / 2)
    return low - room, high + room


def _ticks(low: float, high: float) -> Iterator[float]:
    """Return round numbers between two."""
    rough = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough)
    first = math.ceil(low / step)
    yield from (round(n * step, 9) for n in range(first, math.floor(high / step) + 1))


def _draw_map(
    draw: ImageDraw.ImageDraw, world: Mapping[str, Any], observed: Observations, top: int
) -> None:
    shapes = [shape for one in world.get("objects", ()) for shape in _outlines(one)]
    path = [(sample.x, sample.y) for sample in observed.motion]
    points = [*path, *observed.path, *(point for _, outline in shapes for point in outline)] or [
        (0.0, 0.0)
    ]
    middle_x = (min(x for x, _ in points) + max(x for x, _ in points)) / 2
    middle_y = (min(y for _, y in points) + max(y for _, y in points)) / 2
    reach = max(2.0, *(abs(x - middle_x) for x, _ in points))
    scale = min(
        (_WIDTH - 2 * _GAP) / 2 / reach,
        (_HEIGHT - 2 * _GAP) / 2 / max(2.0, *(abs(y - middle_y) for _, y in points)),
    )

    def place(x: float, y: float) -> tuple[float, float]:
        across = 1.5 * _WIDTH + (x - middle_x) * scale
        return across, top + _HEIGHT / 2 - (y - middle_y) * scale

    draw.text((_WIDTH + _GAP, top + 6), "driven path, x to the right [m]", _INK)
    for is_open, outline in shapes:
        corners = [place(*point) for point in outline]
        draw.line(corners, _SHAPE, 3) if is_open else draw.polygon(corners, _SHAPE)
    if len(observed.path) > 1:
        draw.line([place(*point) for point in observed.path], _DESIRED, 5)
    for piece in _pieces(path):
        draw.line([place(*point) for point in piece], _MEASURED, 2)
    for touch in observed.touches[:1]:
        x, y = place(touch.x, touch.y)
        draw.text((x + 8, y), f"touches {touch.body}", _DESIRED)
    if path:
        x, y = place(*path[0])
        draw.ellipse((x - 4, y - 4, x + 4, y + 4), _START)


def _pieces(path: _Points) -> Iterator[list[tuple[float, float]]]:
    """Return the parts of a path between the places where the robot was put elsewhere."""
    piece: list[tuple[float, float]] = []
    for point in path:
        if piece and math.dist(piece[-1], point) > _BREAK:
            if len(piece) > 1:
                yield piece
            piece = []
        piece.append(point)
    if len(piece) > 1:
        yield piece


def _outlines(thing: Mapping[str, Any]) -> Iterator[tuple[bool, list[tuple[float, float]]]]:
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
