"""Which arrows go back, columns, parts and cycles."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.drawing.order import backward, columns, cycles, parts, reading_order

_NAMES = [f"v{number}" for number in range(9)]
_ARROWS = st.lists(st.tuples(st.sampled_from(_NAMES), st.sampled_from(_NAMES)), max_size=25)


def test_the_arrow_that_closes_a_cycle_goes_back() -> None:
    arrows = [("source", "a"), ("a", "b"), ("b", "c"), ("c", "a"), ("c", "sink")]
    assert backward(["a", "b", "c", "source", "sink"], arrows) == {("c", "a")}


def test_nothing_goes_back_without_cycles() -> None:
    assert backward(["c", "b", "a"], [("a", "b"), ("b", "c"), ("a", "c")]) == set()


@given(_ARROWS)
def test_every_other_arrow_goes_to_a_later_column(arrows: list[tuple[str, str]]) -> None:
    back = backward(_NAMES, arrows)
    column = columns(_NAMES, [arrow for arrow in arrows if arrow not in back])
    assert all(column[a] < column[b] for a, b in arrows if (a, b) not in back)
    assert min(column.values()) == 0


def test_what_feeds_a_late_vertex_stands_next_to_it() -> None:
    arrows = [("a", "b"), ("b", "c"), ("late", "c"), ("late", "d"), ("c", "d")]
    assert columns(["a", "b", "c", "d", "late"], arrows)["late"] == 1


def test_parts_hang_together_and_the_largest_is_first() -> None:
    assert parts(["x", "a", "b", "c"], [("b", "a"), ("c", "a")]) == [["a", "b", "c"], ["x"]]


def test_a_cycle_is_a_shortest_way_back() -> None:
    arrows = [("a", "b"), ("b", "c"), ("c", "a"), ("b", "a"), ("d", "d"), ("c", "e")]
    assert cycles(["a", "b", "c", "d", "e"], arrows) == [["a", "b"], ["c", "a", "b"], ["d"]]


@given(_ARROWS)
def test_cycles_are_ways_along_arrows(arrows: list[tuple[str, str]]) -> None:
    found = cycles(_NAMES, arrows)
    for way in found:
        assert set(zip(way, [*way[1:], way[0]], strict=True)) <= set(arrows)
    inside = {vertex for way in found for vertex in way}
    back = backward(_NAMES, arrows)
    assert bool(inside) == bool(back)


def test_one_reads_part_by_part_and_from_left_to_right() -> None:
    arrows = [("b", "a"), ("a", "c"), ("x", "y")]
    assert reading_order(["a", "b", "c", "y", "x", "z"], arrows) == ["b", "a", "c", "x", "y", "z"]
