"""What a laid out picture is, and how several become one.

Sizes are in whatever the caller measures in, y grows downwards. Must not know how boxes find their
places.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

Point = tuple[float, float]

GAP = 16.0  # between boxes
_PART = 34.0  # between parts that are not connected


@dataclass(frozen=True, slots=True)
class Box:
    """What stands in a picture.

    Attributes:
        width: How wide it is.
        height: How high it is at least; many lines at a side make it higher.
        is_round: An ellipse; else a rectangle.
        group: What it is framed with; "" for nothing.
    """

    width: float
    height: float
    is_round: bool = False
    group: str = ""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is: its middle and its size."""

    x: float
    y: float
    width: float
    height: float

    def moved(self, x: float, y: float) -> "Place":
        """The same elsewhere."""
        return replace(self, x=self.x + x, y=self.y + y)


@dataclass(frozen=True, slots=True)
class Layout:
    """A picture, its upper left corner at 0, 0.

    Attributes:
        boxes: By name.
        lines: By their ends, in the order of ``arrows``: from the first box to the second one.
            Of the points, every second step, beginning with the first, is level; the others are
            curves that begin and end level.
        frames: By group.
        width: Of all.
        height: Of all.
    """

    boxes: Mapping[str, Place] = field(default_factory=dict)
    lines: Sequence[Sequence[Point]] = ()
    frames: Mapping[str, Place] = field(default_factory=dict)
    width: float = 0.0
    height: float = 0.0


def stacked(pictures: Sequence[tuple[Sequence[int], Layout]], alone: Layout, count: int) -> Layout:
    """Pictures, each with the numbers of its lines, one below the other."""
    boxes: dict[str, Place] = {}
    lines: list[Sequence[Point]] = [()] * count
    top = width = 0.0
    for numbers, picture in (*pictures, ((), alone)):
        boxes.update({name: place.moved(0, top) for name, place in picture.boxes.items()})
        for number, line in zip(numbers, picture.lines, strict=True):
            lines[number] = [(x, y + top) for x, y in line]
        width = max(width, picture.width)
        top += picture.height + _PART if picture.boxes else 0
    return Layout(boxes, lines, {}, width, max(0.0, top - _PART))


def in_rows(boxes: Mapping[str, Box], widest: float) -> Layout:
    """Boxes that nothing is connected to, in rows."""
    places: dict[str, Place] = {}
    x = y = height = width = 0.0
    for name, box in boxes.items():
        if x and x + box.width > widest:
            x, y, height = 0.0, y + height + GAP, 0.0
        places[name] = Place(x + box.width / 2, y + box.height / 2, box.width, box.height)
        height = max(height, box.height)
        width = max(width, x + box.width)
        x += box.width + 2 * GAP
    return Layout(places, (), {}, width, y + height)


def at_corner(
    places: Mapping[str, Place], lines: Sequence[Sequence[Point]], frames: Mapping[str, Place]
) -> Layout:
    """A picture moved so that its upper left corner is at 0, 0."""
    rectangles = [*places.values(), *frames.values()]
    points = [point for line in lines for point in line]
    xs = [place.x + side * place.width / 2 for place in rectangles for side in (-1, 1)]
    ys = [place.y + side * place.height / 2 for place in rectangles for side in (-1, 1)]
    xs += [x for x, _ in points]
    ys += [y for _, y in points]
    if not xs:
        return Layout()
    x, y = -min(xs), -min(ys)
    return Layout(
        {name: place.moved(x, y) for name, place in places.items()},
        [[(px + x, py + y) for px, py in line] for line in lines],
        {group: place.moved(x, y) for group, place in frames.items()},
        max(xs) + x,
        max(ys) + y,
    )
