"""The order in which data flow, parts and cycles."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.drawing.order import cycles, flow_order, parts, reading_order

_NAMES = [f"v{number}" for number in range(9)]
_ARROWS = st.lists(st.tuples(st.sampled_from(_NAMES), st.sampled_from(_NAMES)), max_size=25)


def _backward(vertices, arrows):
    place = {vertex: number for number, vertex in enumerate(flow_order(vertices, arrows))}
    return {(a, b) for a, b in arrows if place[a] >= place[b]}


def test_the_arrow_that_closes_a_cycle_goes_back():
    arrows = [("source", "a"), ("a", "b"), ("b", "c"), ("c", "a"), ("c", "sink")]
    assert _backward(["a", "b", "c", "source", "sink"], arrows) == {("c", "a")}


def test_nothing_goes_back_without_cycles():
    assert _backward(["c", "b", "a"], [("a", "b"), ("b", "c"), ("a", "c")]) == set()


@given(_ARROWS)
def test_each_vertex_is_in_the_order_once(arrows):
    assert sorted(flow_order(_NAMES, arrows)) == _NAMES
    assert sorted(reading_order(_NAMES, arrows)) == _NAMES


def test_parts_hang_together_and_the_largest_is_first():
    assert parts(["x", "a", "b", "c"], [("b", "a"), ("c", "a")]) == [["a", "b", "c"], ["x"]]


def test_a_cycle_is_a_shortest_way_back():
    arrows = [("a", "b"), ("b", "c"), ("c", "a"), ("b", "a"), ("d", "d"), ("c", "e")]
    assert cycles(["a", "b", "c", "d", "e"], arrows) == [["a", "b"], ["c", "a", "b"], ["d"]]


@given(_ARROWS)
def test_cycles_are_ways_along_arrows(arrows):
    found = cycles(_NAMES, arrows)
    for way in found:
        assert set(zip(way, [*way[1:], way[0]], strict=True)) <= set(arrows)
    inside = {vertex for way in found for vertex in way}
    assert bool(inside) == bool(_backward(_NAMES, arrows))


def test_one_reads_part_by_part_and_from_left_to_right():
    arrows = [("b", "a"), ("a", "c"), ("x", "y")]
    assert reading_order(["a", "b", "c", "y", "x", "z"], arrows) == ["b", "a", "c", "x", "y", "z"]
