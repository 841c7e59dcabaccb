"""Diagrams from a few words."""

import re
from dataclasses import replace
from itertools import pairwise

import pytest

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation


@pytest.fixture
def draw():
    """``draw("/a > /t", "/t > /b", "/alone")``: a diagram of members, topics and arrows.

    Topics are the names that are capitals, or whose last part is "t" and a number; all others are
    members. ``changes`` has by name what is different of them.
    """

    def build(*words, changes=None, **of_diagram):
        names = list(dict.fromkeys(name for word in words for name in word.split(" > ")))
        channels = [name for name in names if _is_channel(name)]
        members = [name for name in names if not _is_channel(name)]
        ids = {name: f"n{number}" for number, name in enumerate(members, 1)}
        ids.update({name: f"t{number}" for number, name in enumerate(channels, 1)})
        changed = changes or {}
        edges = []
        for word in words:
            parts = word.split(" > ")
            for source, target in pairwise(parts):
                flow = Relation.PUBLISHES if _is_channel(target) else Relation.SUBSCRIBES
                edges.append(Edge(ids[source], ids[target], flow))
        return Diagram(
            tuple(replace(Member(ids[n], n, pid=1), **changed.get(n, {})) for n in members),
            tuple(replace(Channel(ids[n], n, ("a/B",)), **changed.get(n, {})) for n in channels),
            tuple(edges),
            **of_diagram,
        )

    return build


def _is_channel(name):
    return name.isupper() or re.fullmatch(r"t\d*", name.rpartition("/")[2]) is not None
