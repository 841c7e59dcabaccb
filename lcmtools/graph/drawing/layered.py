"""Positions for the vertices of a diagram: columns in the direction of flow, bands for groups.

Pure geometry: sizes and arrows in, positions out; lengths in pixels, y downwards. Layered drawing
after K. Sugiyama, S. Tagawa, M. Toda: Methods for visual understanding of hierarchical system
structures, 1981. Vertices that remain keep their order from one drawing to the next.
"""

from bisect import bisect_right, insort
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

from lcmtools.graph.drawing.order import Arrow, flow_order

Size: TypeAlias = tuple[float, float]
Point: TypeAlias = tuple[float, float]

_COLUMN_GAP, _ROW_GAP = 84.0, 14.0
_PASSING = 6.0  # height of an arrow that passes a column
_BAND_GAP, _MARGIN = 34.0, 22.0
_SWEEPS, _MOVES = 12, 16


@dataclass(frozen=True, slots=True)
class Drawing:
    """The positions of everything."""

    places: dict[str, Point] = field(default_factory=dict)  # centres of vertices
    ways: dict[Arrow, list[Point]] = field(default_factory=dict)  # between sides of vertices
    bands: dict[str, tuple[float, float]] = field(default_factory=dict)  # y of top and bottom
    size: Size = (0.0, 0.0)


@dataclass(slots=True)
class _Cell:  # a place in a column: a vertex, or an arrow that passes the column
    layer: int
    band: str
    height: float
    y: float = 0.0
    left: list["_Cell"] = field(default_factory=list)
    right: list["_Cell"] = field(default_factory=list)


def layered(
    sizes: Mapping[str, Size],
    arrows: Sequence[Arrow],
    bands: Mapping[str, str] | None = None,
    before: Mapping[str, Point] | None = None,
) -> Drawing:
    """Return a drawing of vertices and arrows.

    Args:
        sizes: Width and height of each vertex.
        arrows: Between vertices, each once.
        bands: The band of each vertex, which vertices of others stay out of; None for one band.
        before: The positions of an earlier drawing; its order is kept if that adds no crossings.
    """
    if not sizes:
        return Drawing()
    bands, before = bands or {}, before or {}
    order = flow_order([*sizes], arrows)
    rank = {vertex: number for number, vertex in enumerate(order)}
    forward = {arrow: rank[arrow[0]] <= rank[arrow[1]] for arrow in arrows}
    flows = {a: a if forward[a] else a[::-1] for a in arrows if a[0] != a[1]}
    layers = _layers(order, flows.values())
    cells = {v: _Cell(layers[v], bands.get(v, ""), sizes[v][1]) for v in order}
    chains = {arrow: _chain(cells, flow) for arrow, flow in flows.items()}
    columns = _columns(cells, chains.values())
    _begin(cells, rank, before)
    for chain in chains.values():
        for passing in chain[1:-1]:
            passing.y = (chain[0].y + chain[-1].y) / 2
    _reduce_crossings(columns)
    return _drawn(sizes, cells, chains, forward, _stack(columns))


def _layers(order: Sequence[str], arrows: Iterable[Arrow]) -> dict[str, int]:
    """Return each vertex's column: after its sources; without any, next to its first target."""
    into, out = defaultdict(list), defaultdict(list)
    for source, target in arrows:
        into[target].append(source)
        out[source].append(target)
    layers: dict[str, int] = {}
    for vertex in order:
        layers[vertex] = max((layers[near] + 1 for near in into[vertex]), default=0)
    for vertex in order:
        if not into[vertex] and out[vertex]:
            layers[vertex] = min(layers[near] for near in out[vertex]) - 1
    return layers


def _chain(cells: Mapping[str, _Cell], arrow: Arrow) -> list[_Cell]:
    """Join the ends of an arrow through the columns that it passes."""
    first, last = cells[arrow[0]], cells[arrow[1]]
    between = range(first.layer + 1, last.layer)
    chain = [first, *(_Cell(layer, last.band, _PASSING) for layer in between), last]
    for one, other in pairwise(chain):
        one.right.append(other)
        other.left.append(one)
    return chain


def _columns(cells: Mapping[str, _Cell], chains: Iterable[Sequence[_Cell]]) -> list[list[_Cell]]:
    columns: dict[int, list[_Cell]] = defaultdict(list)
    for cell in (*cells.values(), *(one for chain in chains for one in chain[1:-1])):
        columns[cell.layer].append(cell)
    return [columns[layer] for layer in sorted(columns)]


def _begin(
    cells: Mapping[str, _Cell], rank: Mapping[str, int], before: Mapping[str, Point]
) -> None:
    """Give vertices the order of an earlier drawing; a new one is placed near its neighbours."""
    old = {id(cells[vertex]): y for vertex, (_, y) in before.items() if vertex in cells}
    for vertex, cell in cells.items():
        near = [old[id(one)] for one in (*cell.left, *cell.right) if id(one) in old]
        usual = sum(near) / len(near) if near else float(rank[vertex])
        cell.y = old.get(id(cell), usual)


def _reduce_crossings(columns: list[list[_Cell]]) -> None:
    """Order each column by the mean positions of its cells' neighbours; keep the best order."""
    for column in columns:
        _sort(column)
    fewest, best = _crossings(columns), [list(column) for column in columns]
    for sweep in range(_SWEEPS):
        if not fewest:
            break
        rightwards = sweep % 2 == 0
        for column in columns if rightwards else reversed(columns):
            for cell in column:
                near = cell.left if rightwards else cell.right
                cell.y = sum(one.y for one in near) / len(near) if near else cell.y
            _sort(column)
        if (now := _crossings(columns)) < fewest:
            fewest, best = now, [list(column) for column in columns]
    columns[:] = best


def _sort(column: list[_Cell]) -> None:
    """Sort a column by bands and positions, and number it."""
    column.sort(key=lambda cell: (not cell.band, cell.band, cell.y))
    for place, cell in enumerate(column):
        cell.y = float(place)


def _crossings(columns: Iterable[Sequence[_Cell]]) -> int:
    count = 0
    for column in columns:
        ends: list[float] = []
        for cell in column:
            targets = sorted(one.y for one in cell.right)
            count += sum(len(ends) - bisect_right(ends, target) for target in targets)
            for target in targets:
                insort(ends, target)
    return count


def _stack(columns: Sequence[Sequence[_Cell]]) -> dict[str, tuple[float, float]]:
    """Give each cell its y, band below band; return the top and bottom of each band."""
    names = {cell.band for column in columns for cell in column}
    found: dict[str, tuple[float, float]] = {}
    top = _MARGIN
    for name in sorted(names, key=lambda name: (not name, name)):
        parts = [[cell for cell in column if cell.band == name] for column in columns]
        _spread([part for part in parts if part], name)
        high = min(cell.y - cell.height / 2 for part in parts for cell in part)
        shift = top + (_BAND_GAP if name else 0.0) - high
        for part in parts:
            for cell in part:
                cell.y += shift
        bottom = max(cell.y + cell.height / 2 for part in parts for cell in part)
        found[name] = (top, bottom + _MARGIN / 2)
        top = bottom + _MARGIN / 2 + _ROW_GAP
    return found


def _spread(parts: Sequence[Sequence[_Cell]], band: str) -> None:
    """Give the cells of a band their y: near their neighbours, without overlaps."""
    for part in parts:
        _place(part, [0.0] * len(part))
    for move in range(_MOVES):
        rightwards = move % 2 == 0
        for part in parts if rightwards else reversed(parts):
            wanted = []
            for cell in part:
                sides = (cell.left, cell.right) if rightwards else (cell.right, cell.left)
                near = next(([o for o in s if o.band == band] for s in sides if s), [])
                wanted.append(sum(one.y for one in near) / len(near) if near else cell.y)
            _place(part, wanted)


def _place(part: Sequence[_Cell], wanted: Sequence[float]) -> None:
    """Place cells in their order as near to their wanted positions as their heights allow.

    Minimizes the squares of the distances, by joining neighbours that would overlap into blocks.
    """
    offsets, offset = [], 0.0
    for above, cell in zip([None, *part], part, strict=False):
        offset += (above.height + cell.height) / 2 + _ROW_GAP if above else 0.0
        offsets.append(offset)
    blocks: list[tuple[float, int]] = []  # mean wanted position and number of a block's cells
    for want, at in zip(wanted, offsets, strict=True):
        mean, count = want - at, 1
        while blocks and blocks[-1][0] >= mean:
            other, more = blocks.pop()
            mean, count = (mean * count + other * more) / (count + more), count + more
        blocks.append((mean, count))
    starts = [mean for mean, count in blocks for _ in range(count)]
    for cell, start, at in zip(part, starts, offsets, strict=True):
        cell.y = start + at


def _drawn(
    sizes: Mapping[str, Size],
    cells: Mapping[str, _Cell],
    chains: Mapping[Arrow, Sequence[_Cell]],
    forward: Mapping[Arrow, bool],
    bands: dict[str, tuple[float, float]],
) -> Drawing:
    widths: dict[int, float] = defaultdict(float)
    for vertex, cell in cells.items():
        widths[cell.layer] = max(widths[cell.layer], sizes[vertex][0])
    lefts, x = {}, _MARGIN
    for layer in sorted(widths):
        lefts[layer] = x
        x += widths[layer] + _COLUMN_GAP
    places = {v: (lefts[c.layer] + widths[c.layer] / 2, c.y) for v, c in cells.items()}
    ways = {}
    for (source, target), chain in chains.items():
        first, last = (source, target) if forward[source, target] else (target, source)
        way = [(places[first][0] + sizes[first][0] / 2, places[first][1])]
        for cell in chain[1:-1]:
            left = lefts[cell.layer]
            way += [(left, cell.y), (left + widths[cell.layer], cell.y)]
        way.append((places[last][0] - sizes[last][0] / 2, places[last][1]))
        ways[source, target] = way if forward[source, target] else way[::-1]
    bottom = max(low for _, low in bands.values())
    return Drawing(places, ways, bands, (x - _COLUMN_GAP + _MARGIN, bottom + _MARGIN))
