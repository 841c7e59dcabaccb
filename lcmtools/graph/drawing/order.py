"""The order of vertices by data flow, connected parts, and cycles.

Functions of vertices (names, in a fixed order) and arrows between them. The same input always gives
the same result.
"""

from collections import deque
from collections.abc import Collection, Iterable, Mapping, Sequence

Arrow = tuple[str, str]


def flow_order(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[str]:
    """Return the vertices in an order in which few arrows, or without cycles none, go back.

    Few, not fewest: vertices are removed one after another, those without inputs to the front,
    those without outputs to the end, and if there are only cycles the one with the most outputs
    minus inputs (P. Eades, X. Lin, W. Smyth: A fast and effective heuristic for the feedback arc
    set problem, 1993).
    """
    after, before = _neighbours(vertices, arrows)
    front: list[str] = []
    end: list[str] = []
    outputs = {vertex: len(near) for vertex, near in after.items()}
    inputs = {vertex: len(near) for vertex, near in before.items()}
    rest = dict.fromkeys(vertices)
    while rest:
        sinks = [v for v in rest if not outputs[v]]
        sources = [v for v in rest if outputs[v] and not inputs[v]]
        if not sinks and not sources:
            sources = [max(rest, key=lambda v: outputs[v] - inputs[v])]
        end = [*sinks, *end]
        front += sources
        for vertex in (*sinks, *sources):
            del rest[vertex]
            for near in after[vertex]:
                inputs[near] -= 1
            for near in before[vertex]:
                outputs[near] -= 1
    return [*front, *end]


def reading_order(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[str]:
    """Return the vertices part by part, each part in the order of data flow."""
    place = {vertex: number for number, vertex in enumerate(flow_order(vertices, arrows))}
    return [v for part in parts(vertices, arrows) for v in sorted(part, key=place.__getitem__)]


def parts(vertices: Sequence[str], arrows: Collection[Arrow]) -> list[list[str]]:
    """Return the connected parts, whatever the arrows' directions; the largest first."""
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
    """Return cycles: a shortest one through each vertex that is on any.

    One for each set of vertices; the first vertex is not repeated at the end. Not all cycles, of
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


_Near = Mapping[str, dict[str, None]]  # a dict, because a set keeps no order


def _neighbours(vertices: Iterable[str], arrows: Collection[Arrow]) -> tuple[_Near, _Near]:
    after: dict[str, dict[str, None]] = {vertex: {} for vertex in vertices}
    before: dict[str, dict[str, None]] = {vertex: {} for vertex in after}
    for source, target in arrows:
        after[source][target] = None
        before[target][source] = None
    return after, before


def _way_back(start: str, after: _Near) -> list[str]:
    """Return a shortest path from a vertex back to itself; [] if there is none."""
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
