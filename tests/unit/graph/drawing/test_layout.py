"""Where boxes stand and lines run."""

from itertools import combinations, pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.graph.drawing.layout import lay_out
from lcmtools.graph.drawing.order import Arrow, backward
from lcmtools.graph.drawing.places import Box, Layout, Place, Point

_NAMES = [f"v{number}" for number in range(12)]
_GROUPS = ["", "", "/a", "/b"]
_BOXES = st.lists(
    st.builds(
        Box,
        st.floats(20, 300),
        st.floats(15, 60),
        is_round=st.booleans(),
        group=st.sampled_from(_GROUPS),
    ),
    min_size=12,
    max_size=12,
)
_PAIRS = [(a, b) for a in _NAMES for b in _NAMES if a != b]
_ARROWS = st.lists(st.sampled_from(_PAIRS), max_size=30, unique=True)


def _edges(place: Place) -> tuple[float, float, float, float]:
    """Left, right, top and bottom."""
    half, high = place.width / 2, place.height / 2
    return place.x - half, place.x + half, place.y - high, place.y + high


def _overlap(one: Place, other: Place) -> bool:
    left, right, top, bottom = _edges(one)
    left2, right2, top2, bottom2 = _edges(other)
    return left < right2 and left2 < right and top < bottom2 and top2 < bottom


def _along(line: list[Point]) -> list[Point]:
    """Points along a line, close to each other, without its ends."""
    found = []
    for number, ((x, y), (x2, y2)) in enumerate(pairwise(line)):
        for step in range(1, 20):
            part = step / 20
            if number % 2 == 0:  # level
                found.append((x + (x2 - x) * part, y))
            else:  # a curve that begins and ends level, as an SVG's is
                rest = 1 - part
                middle = (x + x2) / 2
                bent = 3 * rest * part * middle
                found.append(
                    (
                        rest**3 * x + bent + part**3 * x2,
                        y * (rest**3 + 3 * rest**2 * part) + y2 * (3 * rest * part**2 + part**3),
                    )
                )
    return found


def _check(picture: Layout, boxes: dict[str, Box], arrows: list[Arrow]) -> None:
    assert picture.boxes.keys() == boxes.keys()
    for one, other in combinations(picture.boxes.values(), 2):
        assert not _overlap(one, other)
    for place in (*picture.boxes.values(), *picture.frames.values()):
        left, right, top, bottom = _edges(place)
        assert -1e-6 <= left <= right <= picture.width + 1e-6
        assert -1e-6 <= top <= bottom <= picture.height + 1e-6
    for (source, target), line in zip(arrows, picture.lines, strict=True):
        for x, y in _along(list(line)):
            for name, place in picture.boxes.items():
                left, right, top, bottom = _edges(place)
                is_inside = left + 0.1 < x < right - 0.1 and top + 0.1 < y < bottom - 0.1
                # an ellipse does not fill its corners
                assert not is_inside or (name in (source, target) and boxes[name].is_round)


@settings(max_examples=60, deadline=None)
@given(_BOXES, _ARROWS)
def test_boxes_do_not_overlap_and_no_line_runs_through_one(
    kinds: list[Box], arrows: list[Arrow]
) -> None:
    boxes = dict(zip(_NAMES, kinds, strict=True))
    _check(lay_out(boxes, arrows), boxes, arrows)


@settings(max_examples=40, deadline=None)
@given(_ARROWS)
def test_lines_go_rightwards_but_for_those_that_close_cycles(arrows: list[Arrow]) -> None:
    boxes = {name: Box(50, 20) for name in _NAMES}
    picture = lay_out(boxes, arrows)
    forth = [line for line in picture.lines if line[0][0] < line[-1][0]]
    whole = backward(_NAMES, arrows)
    assert len(picture.lines) - len(forth) <= len(arrows) / 2
    if not whole:
        assert len(forth) == len(arrows)
    for line in picture.lines:
        steps = [b[0] - a[0] for a, b in pairwise(line)]
        assert min(steps) > -1e-6 or max(steps) < 1e-6


def test_lines_begin_and_end_at_their_boxes() -> None:
    boxes = {"a": Box(50, 20), "b": Box(80, 30, is_round=True), "c": Box(10, 10)}
    arrows = [("a", "b"), ("b", "c"), ("c", "a")]
    picture = lay_out(boxes, arrows)
    for (source, target), line in zip(arrows, picture.lines, strict=True):
        for name, (x, y) in ((source, line[0]), (target, line[-1])):
            left, right, top, bottom = _edges(picture.boxes[name])
            assert left - 1e-6 <= x <= right + 1e-6
            assert top <= y <= bottom


def test_the_same_input_gives_the_same_picture() -> None:
    boxes = {name: Box(50, 20, group=_GROUPS[len(name) % 3]) for name in _NAMES}
    arrows = _PAIRS[::7]
    assert lay_out(boxes, arrows) == lay_out(dict(boxes), list(arrows))


def test_frames_hold_their_boxes_and_nobody_elses() -> None:
    boxes = {name: Box(60, 20, group=_GROUPS[n % 4]) for n, name in enumerate(_NAMES)}
    picture = lay_out(boxes, _PAIRS[::5])
    assert picture.frames.keys() == {"/a", "/b"}
    for group, frame in picture.frames.items():
        for name, place in picture.boxes.items():
            assert _overlap(frame, place) is (boxes[name].group == group)
    assert not _overlap(*picture.frames.values())


def test_crossings_are_avoided_where_they_can_be() -> None:
    boxes = {name: Box(50, 20) for name in ("a", "b", "c", "x", "y", "z")}
    arrows = [("a", "z"), ("b", "y"), ("c", "x"), ("a", "y"), ("b", "x")]
    places = lay_out(boxes, arrows).boxes
    left = sorted("abc", key=lambda name: places[name].y)
    right = sorted("xyz", key=lambda name: places[name].y)
    assert [left, right] in ([list("abc"), list("zyx")], [list("cba"), list("xyz")])


def test_a_long_line_is_straight_where_nothing_is_in_its_way() -> None:
    boxes = {name: Box(50, 20) for name in "abcde"}
    arrows = [("a", "b"), ("b", "c"), ("c", "d"), ("d", "e"), ("a", "e")]
    (line,) = lay_out(boxes, arrows).lines[-1:]
    heights = [y for _, y in line[2:-2]]
    assert max(heights) - min(heights) < 1


def test_a_hub_is_high_enough_for_its_lines() -> None:
    boxes = {"hub": Box(50, 20), **{name: Box(50, 20) for name in _NAMES}}
    picture = lay_out(boxes, [("hub", name) for name in _NAMES])
    starts = sorted(line[0][1] for line in picture.lines)
    assert all(b - a > 6 for a, b in pairwise(starts))


def test_what_is_alone_stands_in_rows() -> None:
    boxes = {f"v{number}": Box(200, 20) for number in range(9)}
    picture = lay_out(boxes, [])
    assert len({place.y for place in picture.boxes.values()}) == 3
    assert picture.width < 1000


def test_nothing_is_a_picture_too() -> None:
    assert lay_out({}, []) == Layout({}, [], {}, 0.0, 0.0)
