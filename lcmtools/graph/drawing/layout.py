"""Where the boxes of a picture stand and how the lines between them run, from left to right.

Boxes stand in columns, and no line runs through a box: it bends between columns only, and passes a
column where room is kept for it. Pure arithmetic; the same input always gives the same picture.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import sqrt

from lcmtools.graph.drawing.columns import Cell, Columns
from lcmtools.graph.drawing.order import Arrow, backward, columns, parts
from lcmtools.graph.drawing.places import (
    GAP,
    Box,
    Layout,
    Place,
    Point,
    at_corner,
    in_rows,
    stacked,
)

_BETWEEN = 46.0  # columns
_STEEPEST = 0.12
"""How much farther apart two columns are for each unit that a line between them goes down."""
_MOST_BETWEEN = 170.0
_LINE = 6.0  # room that a passing line has
_PORTS = 9.0  # between lines at a box's side
_TALLEST = 260.0  # that a box becomes for the lines at its side
_FRAME = 16.0  # around the boxes of a group
_TITLE = 18.0  # above them
_WIDEST = 900.0  # a row of boxes that nothing is connected to


def lay_out(boxes: Mapping[str, Box], arrows: Sequence[Arrow], label_width: float = 0.0) -> Layout:
    """A picture of boxes and arrows.

    Args:
        boxes: By name, in an order that is kept where nothing speaks against it.
        arrows: From box to box, none to itself; there may be several between two boxes.
        label_width: The widest label that is written on a line between two columns.
    """
    names = list(boxes)
    if any(box.group for box in boxes.values()):
        return _Part(boxes, arrows, label_width).layout()
    found = parts(names, arrows)
    pictures = []
    for part in found:
        inside = set(part)
        own = [number for number, arrow in enumerate(arrows) if arrow[0] in inside]
        if own:
            there = {name: boxes[name] for name in part}
            picture = _Part(there, [arrows[number] for number in own], label_width).layout()
            pictures.append((own, picture))
    alone = {part[0]: boxes[part[0]] for part in found if len(part) == 1}
    widest = max((picture.width for _, picture in pictures), default=0.0)
    return stacked(pictures, in_rows(alone, max(widest, _WIDEST)), len(arrows))


@dataclass(frozen=True, slots=True)
class _Wire:
    """A line on its way from left to right.

    Attributes:
        stops: What it touches: a box, bends in the columns between, a box.
        is_back: It is drawn from right to left.
    """

    stops: tuple[str, ...]
    is_back: bool


class _Part:
    """Boxes that hang together, or stand in groups."""

    def __init__(
        self, boxes: Mapping[str, Box], arrows: Sequence[Arrow], label_width: float
    ) -> None:
        self._label_width = label_width
        self._lanes = _lanes({box.group for box in boxes.values()})
        back = backward(list(boxes), arrows)
        ways = [(b, a) if (a, b) in back else (a, b) for a, b in arrows]
        column = columns(list(boxes), dict.fromkeys(ways))
        self._boxes = _tall_enough(boxes, ways)
        self._cells = {
            name: Cell(column[name], box.height, self._lanes[box.group])
            for name, box in self._boxes.items()
        }
        self._wires = [
            self._wire(number, way, is_back=arrow in back)
            for number, (way, arrow) in enumerate(zip(ways, arrows, strict=True))
        ]

    def layout(self) -> Layout:
        """The picture."""
        pairs = [pair for w in self._wires for pair in pairwise(w.stops)]
        order = Columns(self._cells, pairs, GAP)
        order.order()
        heights = self._with_lanes_apart(order.heights())
        edges = self._edges(heights, pairs)
        places = {}
        for name, box in self._boxes.items():
            left, right = edges[self._cells[name].column]
            places[name] = Place((left + right) / 2, heights[name], box.width, box.height)
        lines = self._lines(places, heights, edges)
        return at_corner(places, lines, self._frames(places, heights))

    def _wire(self, number: int, way: Arrow, *, is_back: bool) -> _Wire:
        """A line, with a bend in each column that it passes."""
        source, target = way
        first, last = self._cells[source], self._cells[target]
        lane = last.lane if first.lane == self._lanes.get("") else first.lane
        bends = []
        for column in range(first.column + 1, last.column):
            bends.append(f"~{number}.{column}")
            self._cells[bends[-1]] = Cell(column, _LINE, lane, is_bend=True)
        return _Wire((source, *bends, target), is_back)

    def _with_lanes_apart(self, heights: Mapping[str, float]) -> dict[str, float]:
        """Room for the frames and their titles between lanes."""
        between = 2 * _FRAME + _TITLE + GAP
        return {name: y + self._cells[name].lane * between for name, y in heights.items()}

    def _edges(
        self, heights: Mapping[str, float], pairs: Iterable[Arrow]
    ) -> list[tuple[float, float]]:
        """Where each column begins and ends, from left to right."""
        count = 1 + max((cell.column for cell in self._cells.values()), default=-1)
        widths = [0.0] * count
        steepest = [0.0] * count
        for name, box in self._boxes.items():
            column = self._cells[name].column
            widths[column] = max(widths[column], box.width)
        for left, right in pairs:
            column = self._cells[left].column
            steepest[column] = max(steepest[column], abs(heights[left] - heights[right]))
        found = []
        x = 0.0
        for width, steep in zip(widths, steepest, strict=True):
            found.append((x, x + width))
            x += width + min(_MOST_BETWEEN, _BETWEEN + _STEEPEST * steep) + self._label_width
        return found

    def _lines(
        self,
        places: Mapping[str, Place],
        heights: Mapping[str, float],
        edges: Sequence[tuple[float, float]],
    ) -> list[list[Point]]:
        starts = self._ports(heights, first=True)
        ends = self._ports(heights, first=False)
        lines = []
        for number, wire in enumerate(self._wires):
            source, *bends, target = wire.stops
            start, end = starts[number], ends[number]
            first, last = self._cells[source].column, self._cells[target].column
            points = [(self._border(source, places, start, 1), start), (edges[first][1], start)]
            for bend in bends:
                left, right = edges[self._cells[bend].column]
                points += [(left, heights[bend]), (right, heights[bend])]
            points += [(edges[last][0], end), (self._border(target, places, end, -1), end)]
            lines.append(points[::-1] if wire.is_back else points)
        return lines

    def _ports(self, heights: Mapping[str, float], *, first: bool) -> dict[int, float]:
        """How high each line leaves its left box, or reaches its right one: in order, apart."""
        at: dict[str, list[tuple[float, int]]] = {}
        for number, wire in enumerate(self._wires):
            own, near = (0, 1) if first else (-1, -2)
            at.setdefault(wire.stops[own], []).append((heights[wire.stops[near]], number))
        found = {}
        for name, known in at.items():
            step = min(_PORTS, 0.7 * self._boxes[name].height / max(1, len(known) - 1))
            top = heights[name] - step * (len(known) - 1) / 2
            for place, (_, number) in enumerate(sorted(known)):
                found[number] = top + place * step
        return found

    def _border(self, name: str, places: Mapping[str, Place], y: float, side: int) -> float:
        """Where a box's border is at a height, on its right side (1) or its left one (-1)."""
        place = places[name]
        half = place.width / 2
        if self._boxes[name].is_round:
            half *= sqrt(max(0.0, 1 - ((y - place.y) / (place.height / 2)) ** 2))
        return place.x + side * half

    def _frames(
        self, places: Mapping[str, Place], heights: Mapping[str, float]
    ) -> dict[str, Place]:
        """Around the boxes of each group, and as high as the lines that pass among them."""
        found = {}
        for group, lane in self._lanes.items():
            inside = [places[name] for name, box in self._boxes.items() if box.group == group]
            if group and inside:
                left = min(place.x - place.width / 2 for place in inside) - _FRAME
                right = max(place.x + place.width / 2 for place in inside) + _FRAME
                cells = {v: cell for v, cell in self._cells.items() if cell.lane == lane}
                top = min(heights[v] - c.height / 2 for v, c in cells.items()) - _FRAME - _TITLE
                bottom = max(heights[v] + c.height / 2 for v, c in cells.items()) + _FRAME
                middle = (left + right) / 2, (top + bottom) / 2
                found[group] = Place(*middle, right - left, bottom - top)
        return found


def _lanes(groups: Collection[str]) -> dict[str, int]:
    """The groups from above; in their middle what stands in none, often connected to them all."""
    named = sorted(set(groups) - {""})
    middle = len(named) // 2
    order = [*named[:middle], *([""] if "" in groups else []), *named[middle:]]
    return {group: number for number, group in enumerate(order)}


def _tall_enough(boxes: Mapping[str, Box], ways: Sequence[Arrow]) -> dict[str, Box]:
    """Boxes with room for the lines at their sides."""
    starts = [source for source, _ in ways]
    ends = [target for _, target in ways]
    found = {}
    for name, box in boxes.items():
        lines = max(starts.count(name), ends.count(name))
        wanted = min(_TALLEST, _PORTS * (lines - 1) / 0.7)
        found[name] = replace(box, height=max(box.height, wanted))
    return found
