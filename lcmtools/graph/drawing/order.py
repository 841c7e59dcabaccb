"""The order of vertices: backward arrows, columns from left to right, parts, and cycles.

Functions of vertices (names, in a fixed order) and arrows between them. The same input always gives
the same result.
"""

from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence
from graphlib import TopologicalSorter

Arrow = tuple[str, str]


def backward(vertices: Sequence[str], arrows: Collection[Arrow]) -> set[Arrow]:
    """The arrows that have to go from right to left, so that all others go from left to right.

    Few, not fewest: vertices are taken off, those without input to the left, those without output
    to the right, and where there are only cycles the one with the most outputs less inputs
    (P. Eades, X. Lin, W. Smyth: A fast and effective heuristic for the feedback arc set problem,
    1993).
    """
    after, before = _neighbours(vertices, arrows)
    left: list[str] = []
    right: list[str] = []
    outputs = {vertex: len(near) for vertex, near in after.items()}
    inputs = {vertex: len(near) for vertex, near in before.items()}
    rest = dict.fromkeys(vertices)
    while rest:
        sinks = dict.fromkeys(v for v in rest if not outputs[v])
        sources = [v for v in rest if v not in sinks and not inputs[v]]
        if not sinks and not sources:
            sources = [max(rest, key=lambda v: outputs[v] - inputs[v])]
        right = [*sinks, *right]
        left += sources
        for vertex in (*sinks, *sources):
            del rest[vertex]
            for near in after[vertex]:
                inputs[near] -= 1
            for near in before[vertex]:
                outputs[near] -= 1
    place = {vertex: number for number, vertex in enumerate([*left, *right])}
    return {(a, b) for a, b in arrows if place[a] >= place[b]}


def columns(vertices: Sequence[str], arrows: Collection[Arrow]) -> dict[str, int]:
    """The column of each vertex, from 0, so that every arrow goes to a later one.

    As far to the left as possible, but vertices with more outputs than inputs as close as possible
    to what they feed. The arrows must have no cycles.
    """
    after, before = _neighbours(vertices, arrows)
    order = list(TopologicalSorter(before).static_order())
    column: dict[str, int] = {}
    for vertex in order:
        column[vertex] = max((column[v] + 1 for v in before[vertex]), default=0)
    for vertex in reversed(order):
        if len(after[vertex]) > len(before[vertex]):
            column[vertex] = min(column[v] for v in after[vertex]) - 1
    lowest = min(column.values(), default=0)
    return {vertex: column[vertex] - lowest for vertex in vertices}


def parts(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[list[str]]:
    """The connected parts, whatever the arrows' directions; the largest first."""
    after, before = _neighbours(vertices, arrows)
    found: list[list[str]] = []
    rest = set(vertices)
    for start in vertices:
        waiting = [start] if start in rest else []
        part = set(waiting)
        while waiting:
            vertex = waiting.pop()
            new = {*after[vertex], *before[vertex]} - part
            part |= new
            waiting += new
        rest -= part
        if part:
            found.append([vertex for vertex in vertices if vertex in part])
    return sorted(found, key=len, reverse=True)


def cycles(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[list[str]]:
    """Cycles: a shortest one through each vertex that is on any.

    One for each set of vertices; the first vertex is not repeated at the end. Not all there are, of
    which there can be very many.
    """
    after, before = _neighbours(vertices, arrows)
    rest = set(vertices)
    while ends := {v for v in rest if rest.isdisjoint(after[v]) or rest.isdisjoint(before[v])}:
        rest -= ends
    found: dict[frozenset[str], list[str]] = {}
    on_one: set[str] = set()
    for vertex in vertices:
        way = _way_back(vertex, after) if vertex in rest - on_one else []
        if way:
            found.setdefault(frozenset(way), way)
            on_one.update(way)
    return list(found.values())


def reading_order(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[str]:
    """The vertices in the order in which one reads: part by part, from left to right."""
    back = backward(vertices, arrows)
    column = columns(vertices, [arrow for arrow in arrows if arrow not in back])
    return [
        vertex
        for part in parts(vertices, arrows)
        for vertex in sorted(part, key=lambda v: column[v])  # sorted keeps the order of equals
    ]


_Near = Mapping[str, dict[str, None]]  # a dict keeps an order, as a set does not


def _neighbours(vertices: Iterable[str], arrows: Collection[Arrow]) -> tuple[_Near, _Near]:
    """The vertices after each vertex, and those before it."""
    after: dict[str, dict[str, None]] = {vertex: {} for vertex in vertices}
    before: dict[str, dict[str, None]] = {vertex: {} for vertex in after}
    for source, target in arrows:
        after[source][target] = None
        before[target][source] = None
    return after, before


def _way_back(start: str, after: _Near) -> list[str]:
    """A shortest way from a vertex that leads back to it; [] if there is none."""
    came: dict[str, str] = {}
    waiting = deque([start])
    while waiting:
        vertex = waiting.popleft()
        if start in after[vertex]:
            way = [vertex]
            while way[-1] != start:
                way.append(came[way[-1]])
            return way[::-1]
        for near in after[vertex]:
            if near not in came:
                came[near] = vertex
                waiting.append(near)
    return []
