"""Places of vertices."""

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.drawing.layered import layered

_SIZE = (100.0, 30.0)


def _sizes(names):
    return dict.fromkeys(names, _SIZE)


def _overlap(drawing, one, other):
    (x, y), (u, v) = drawing.places[one], drawing.places[other]
    return abs(x - u) < _SIZE[0] and abs(y - v) < _SIZE[1]


def test_data_flow_to_the_right():
    drawing = layered(_sizes("abcd"), [("a", "b"), ("b", "c"), ("a", "c"), ("d", "c")])
    x = {name: place[0] for name, place in drawing.places.items()}
    assert x["a"] < x["b"] < x["c"]
    assert x["d"] == x["b"]  # beside what it feeds
    assert drawing.ways["a", "b"][0] == (x["a"] + 50, drawing.places["a"][1])
    assert drawing.ways["a", "b"][-1][0] == x["b"] - 50


def test_a_way_back_begins_at_its_source():
    drawing = layered(_sizes("abc"), [("a", "b"), ("b", "c"), ("c", "a")])
    way = drawing.ways["c", "a"]
    assert abs(way[0][0] - drawing.places["c"][0]) == 50
    assert abs(way[-1][0] - drawing.places["a"][0]) == 50


def test_arrows_do_not_cross_where_they_need_not():
    drawing = layered(_sizes("abcd"), [("a", "d"), ("b", "c")])
    y = {name: place[1] for name, place in drawing.places.items()}
    assert (y["a"] < y["b"]) == (y["d"] < y["c"])


def test_what_stays_keeps_its_order():
    arrows = [("a", "m"), ("b", "n"), ("c", "o")]
    first = layered(_sizes("cbaonm"), arrows)
    second = layered(_sizes("abcmnox"), [*arrows, ("x", "m")], before=first.places)
    order = [sorted("abc", key=lambda v: d.places[v][1]) for d in (first, second)]
    assert order[0] == order[1]


def test_bands_are_apart():
    bands = {"a": "/x", "b": "/y", "c": "/x", "d": "/y", "e": ""}
    drawing = layered(_sizes("abcde"), [("a", "d"), ("b", "c"), ("e", "c")], bands)
    assert list(drawing.bands) == ["/x", "/y", ""]
    for vertex, band in bands.items():
        for other, (top, bottom) in drawing.bands.items():
            y = drawing.places[vertex][1]
            assert (top <= y - 15 and y + 15 <= bottom) == (band == other)


_ARROWS = st.lists(st.tuples(*[st.sampled_from("abcdefghij")] * 2), unique=True, max_size=30)


@given(_ARROWS, st.lists(st.sampled_from(["", "/x", "/y"]), min_size=10, max_size=10))
def test_nothing_lies_on_another(arrows, bands):
    drawing = layered(_sizes("abcdefghij"), arrows, dict(zip("abcdefghij", bands, strict=True)))
    assert not [pair for pair in combinations("abcdefghij", 2) if _overlap(drawing, *pair)]
    assert {arrow for arrow in arrows if arrow[0] != arrow[1]} == drawing.ways.keys()
    width, height = drawing.size
    assert all(0 < x < width and 0 < y < height for x, y in drawing.places.values())
