"""A diagram as a picture: one SVG file that needs nothing else, on a white ground.

Text is written in a monospaced font, whose widths are known without one being there.
"""

from collections.abc import Iterable, Sequence
from unicodedata import combining, east_asian_width
from xml.sax.saxutils import escape

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Flow, Member, printable
from lcmtools.graph.drawing.labels import (
    edge_label,
    edge_tip,
    vertex_labels,
    vertex_tips,
)
from lcmtools.graph.drawing.layout import lay_out
from lcmtools.graph.drawing.places import Box, Layout, Place, Point

_LETTER = 7.3  # width of a letter of the first line
_SMALL = 6.1  # of the other lines
_FIRST = 17.0  # height of the first line
_NEXT = 14.0  # of the others
_PAD = 9.0
_ROUNDER = 1.16, 1.28  # so much wider and higher than a line of text is an ellipse around it
_MUCH_ROUNDER = 1.3, 1.5  # than several lines
_MARGIN = 20.0
_FONT = "'DejaVu Sans Mono', Menlo, Consolas, 'Liberation Mono', monospace"

_STYLE = """\
  text { font-family: %s; text-anchor: middle; fill: #212121; }
  .first { font-size: 12px; }
  .next { font-size: 10px; fill: #616161; }
  .edge { fill: none; stroke: #546e7a; stroke-width: 1.2; }
  .call { stroke: #558b2f; stroke-dasharray: 5 3; }
  .beside { font-size: 10px; fill: #37474f; }
  .ground { fill: #ffffff; fill-opacity: 0.85; }
  .node { fill: #e3f2fd; stroke: #1565c0; stroke-width: 1.4; }
  .program { fill: #ffffff; stroke: #616161; stroke-width: 1.4; stroke-dasharray: 5 3; }
  .stale { fill: #ffffff; stroke: #c62828; stroke-width: 1.4; stroke-dasharray: 5 3; }
  .stale-text { fill: #c62828; }
  .topic { fill: #fafafa; stroke: #455a64; }
  .service { fill: #f1f8e9; stroke: #558b2f; }
  .frame { fill: #f7f7f7; stroke: #bdbdbd; }
  .frame-text { font-size: 12px; fill: #616161; text-anchor: start; }"""
_ARROWS = """\
  <marker id="arrow" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7"
    orient="auto"><path d="M0,0.8 L8,4 L0,7.2 z" fill="#546e7a"/></marker>
  <marker id="call-arrow" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7"
    orient="auto"><path d="M0,0.8 L8,4 L0,7.2 z" fill="#558b2f"/></marker>"""


def write(diagram: Diagram) -> str:
    """The document of a diagram, ended by a newline."""
    picture = _Picture(diagram)
    width, height = picture.size()
    size = f'width="{_n(width)}" height="{_n(height)}"'
    rows = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 {_n(width)} {_n(height)}">',
        "<title>lcmtools graph</title>",
        f"<style>\n{_STYLE % _FONT}\n</style>",
        f"<defs>\n{_ARROWS}\n</defs>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        f'<g transform="translate({_n(_MARGIN)},{_n(_MARGIN)})">',
        *picture.rows(),
        "</g>",
        "</svg>",
    ]
    return "\n".join([*rows, ""])


class _Picture:
    """A diagram laid out. An arrow between two members carries its topics as a box of their own."""

    def __init__(self, diagram: Diagram) -> None:
        self._diagram = diagram
        self._labels = vertex_labels(diagram)
        self._tips = vertex_tips(diagram)
        self._beside = {
            f"e{number}": edge_label(edge)
            for number, edge in enumerate(diagram.edges)
            if edge.topics
        }
        self._layout, self._lines = self._laid_out()

    def size(self) -> tuple[float, float]:
        """Width and height of all."""
        return self._layout.width + 2 * _MARGIN, self._layout.height + 2 * _MARGIN

    def rows(self) -> Iterable[str]:
        """The elements, what lies below first."""
        for group, place in self._layout.frames.items():
            yield _frame(group, place)
        for edge, lines in zip(self._diagram.edges, self._lines, strict=True):
            yield _edge(edge, lines)
        for name, label in self._beside.items():
            yield _beside(self._layout.boxes[name], label)
        for member in self._diagram.members:
            yield self._vertex(member.id, _kind(member), is_round=True)
        for channel in self._diagram.channels:
            yield self._vertex(channel.id, "service" if channel.is_service else "topic")

    def _laid_out(self) -> tuple[Layout, list[list[Sequence[Point]]]]:
        """The layout, and the lines of each edge: two where its topics stand between."""
        boxes = {m.id: self._box(m.id, m) for m in self._diagram.members}
        boxes.update({c.id: self._box(c.id, c) for c in self._diagram.channels})
        boxes.update({name: Box(*_label_size(label)) for name, label in self._beside.items()})
        arrows: list[tuple[str, str]] = []
        counts = []
        widest = 0.0
        for number, edge in enumerate(self._diagram.edges):
            if edge.topics:
                arrows += [(edge.source, f"e{number}"), (f"e{number}", edge.target)]
            else:
                arrows.append((edge.source, edge.target))
                widest = max([widest, *(_width(row, _SMALL) for row in edge_label(edge))])
            counts.append(2 if edge.topics else 1)
        layout = lay_out(boxes, arrows, widest)
        lines = iter(layout.lines)
        return layout, [[next(lines) for _ in range(count)] for count in counts]

    def _box(self, name: str, vertex: Member | Channel) -> Box:
        label = self._labels[name]
        group = vertex.group if self._diagram.is_grouped else ""
        width, height = _text_size(label)
        if isinstance(vertex, Member):
            wider, higher = _ROUNDER if len(label) == 1 else _MUCH_ROUNDER
            return Box(width * wider + 2 * _PAD, height * higher + _PAD, is_round=True, group=group)
        return Box(width + 2 * _PAD, height + _PAD, group=group)

    def _vertex(self, name: str, kind: str, *, is_round: bool = False) -> str:
        place = self._layout.boxes[name]
        x, y, width, height = place.x, place.y, place.width, place.height
        if is_round:
            shape = (
                f'<ellipse class="{kind}" cx="{_n(x)}" cy="{_n(y)}" rx="{_n(width / 2)}"'
                f' ry="{_n(height / 2)}"/>'
            )
        else:
            radius = 8 if kind == "service" else 2
            shape = (
                f'<rect class="{kind}" x="{_n(x - width / 2)}" y="{_n(y - height / 2)}"'
                f' width="{_n(width)}" height="{_n(height)}" rx="{radius}"/>'
            )
        more = " stale-text" if kind == "stale" else ""
        tip = escape("\n".join(self._tips[name]))
        text = _text(x, y, self._labels[name], ("first", "next"), more)
        return f"<g><title>{tip}</title>{shape}{text}</g>"


def _kind(member: Member) -> str:
    if member.stale:
        return "stale"
    return "node" if member.is_node else "program"


def _frame(group: str, place: Place) -> str:
    left, top = place.x - place.width / 2, place.y - place.height / 2
    return (
        f'<rect class="frame" x="{_n(left)}" y="{_n(top)}" width="{_n(place.width)}"'
        f' height="{_n(place.height)}" rx="6"/>'
        f'<text class="frame-text" x="{_n(left + 8)}" y="{_n(top + 16)}">'
        f"{escape(printable(group))}</text>"
    )


def _edge(edge: Edge, lines: Sequence[Sequence[Point]]) -> str:
    is_call = edge.flow in (Flow.CALLS, Flow.SERVES)
    rows = []
    for number, line in enumerate(lines, 1):
        head = "call-arrow" if is_call else "arrow"
        end = f' marker-end="url(#{head})"' if number == len(lines) else ""
        kind = "edge call" if is_call else "edge"
        rows.append(f'<path class="{kind}" d="{_path(line)}"{end}/>')
    if not edge.topics and edge_label(edge):
        label = edge_label(edge)
        x, y = _middle(lines[0])
        rows.append(_beside(Place(x, y, *_label_size(label)), label))
    tip = escape("\n".join(edge_tip(edge)))
    return f"<g><title>{tip}</title>{''.join(rows)}</g>"


def _path(points: Sequence[Point]) -> str:
    """Level steps and curves in turn; see ``Layout.lines``."""
    x, y = points[0]
    words = [f"M{_n(x)},{_n(y)}"]
    for number, (x2, y2) in enumerate(points[1:]):
        if number % 2 == 0 or y == y2:
            words.append(f"L{_n(x2)},{_n(y2)}")
        else:
            middle = (x + x2) / 2
            words.append(f"C{_n(middle)},{_n(y)} {_n(middle)},{_n(y2)} {_n(x2)},{_n(y2)}")
        x, y = x2, y2
    return " ".join(words)


def _middle(points: Sequence[Point]) -> Point:
    """The middle of the last curve."""
    (x, y), (x2, y2) = points[-3], points[-2]
    return (x + x2) / 2, (y + y2) / 2


def _beside(place: Place, label: Sequence[str]) -> str:
    ground = (
        f'<rect class="ground" x="{_n(place.x - place.width / 2)}"'
        f' y="{_n(place.y - place.height / 2)}" width="{_n(place.width)}"'
        f' height="{_n(place.height)}"/>'
    )
    return ground + _text(place.x, place.y, label, ("beside", "beside"))


def _label_size(label: Sequence[str]) -> tuple[float, float]:
    """The room of what is written on a line."""
    return max(_width(row, _SMALL) for row in label) + _PAD / 2, len(label) * _NEXT


def _text_size(label: Sequence[str]) -> tuple[float, float]:
    widths = [_width(label[0], _LETTER), *(_width(row, _SMALL) for row in label[1:])]
    return max(widths), _FIRST + _NEXT * (len(label) - 1)


def _width(text: str, letter: float) -> float:
    """How wide a text is: signs of East Asia are twice as wide, and some stand on others."""
    units = (0 if combining(c) else 2 if east_asian_width(c) in "WF" else 1 for c in text)
    return letter * sum(units)


def _text(x: float, y: float, label: Sequence[str], kinds: tuple[str, str], more: str = "") -> str:
    """Lines around a point, the first in a style of its own."""
    first = _FIRST if kinds[0] == "first" else _NEXT
    height = first + _NEXT * (len(label) - 1)
    rows = []
    base = y - height / 2 + first - 4.5
    for number, row in enumerate(label):
        kind = kinds[0] if number == 0 else kinds[1]
        rows.append(
            f'<text class="{kind}{more}" x="{_n(x)}" y="{_n(base + number * _NEXT)}"'
            f' xml:space="preserve">{escape(row)}</text>'
        )
    return "".join(rows)


def _n(value: float) -> str:
    """A number with as many digits as a picture needs."""
    return f"{value:.1f}".removesuffix(".0")
