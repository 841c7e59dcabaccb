"""The tree of frames as a page gets it: its order, its ages, and what is wrong with it."""

import pytest
from fixtures.gui import FakeSource

from lcmtools.gui.streams.frame_tree import FrameTree
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.std_msgs import String
from lcmtools.types.tf2_msgs import TFMessage


def transforms(*pairs):
    """A message with transforms, each given as "parent child"."""
    found = TFMessage()
    for pair in pairs:
        one = TransformStamped()
        one.header.frame_id, one.child_frame_id = pair.split(" ")
        found.transforms.append(one)
    return found


@pytest.fixture
def source():
    """A bus with transforms on /tf and /other."""
    found = FakeSource()
    found.know(tf=TFMessage, other=TFMessage, text=String)
    return found


def opened(source):
    stream = FrameTree(source)
    stream.update()
    return stream


def lines(stream):
    return stream.update().data["lines"]


def set_time(source, seconds):
    latest = source.latest
    graph = latest.graph._replace(time=round(seconds * 1e9))
    source.latest = type(latest)(latest.rows, graph=graph)


def test_each_frame_is_below_its_parent_with_its_age_and_topic(source):
    stream = opened(source)
    source.put("/tf", transforms("odom base", "world odom", "base wheel"), 10.0)
    source.put("/other", transforms("world box"), 11.5)
    set_time(source, 12.0)
    assert lines(stream) == [
        ["world", 0, None, "", "", ""],
        ["box", 1, 0.5, "unknown sender", "/other", ""],
        ["odom", 1, 2.0, "unknown sender", "/tf", ""],
        ["base", 2, 2.0, "unknown sender", "/tf", ""],
        ["wheel", 3, 2.0, "unknown sender", "/tf", ""],
    ]
    assert stream.problem() == ""


@pytest.mark.parametrize(
    ("messages", "about", "faults"),
    [
        (["a b", "c d"], "2 trees that nothing connects: a, c", {}),
        (["a b", "c b"], "", {"b": "also in a, by unknown sender"}),
        (["a b", "b a", "b c"], "", {"a": "a loop: a in b in a", "b": "a loop: b in a in b"}),
    ],
)
def test_what_is_no_tree_is_named(source, messages, about, faults):
    stream = opened(source)
    for number, pair in enumerate(messages):
        source.put("/tf", transforms(pair), 10.0 + number / 10)
    update = stream.update()
    assert update.data["about"] == about
    found = {line[0]: line[5] for line in update.data["lines"]}
    assert {name: fault for name, fault in found.items() if fault} == faults


def test_a_frame_that_moved_to_another_parent_long_ago_has_only_that_one(source):
    stream = opened(source)
    source.put("/tf", transforms("a b"), 10.0)
    source.put("/tf", transforms("c b"), 20.0)
    assert [line[:2] for line in lines(stream)] == [["c", 0], ["b", 1]]


def test_a_frame_that_is_no_longer_published_is_old_unless_it_was_said_once(source):
    stream = opened(source)
    source.put("/tf", transforms("a once", "a often"), 10.0)
    source.put("/tf", transforms("a often"), 10.1)
    set_time(source, 20.0)
    assert {line[0]: line[5] for line in lines(stream)} == {"a": "", "once": "", "often": "old"}


def test_a_transform_that_is_ignored_is_named_and_the_others_are_there(source):
    stream = opened(source)
    source.put("/tf", transforms("a a", "a b"), 10.0)
    assert [line[0] for line in lines(stream)] == ["a", "b"]
    assert stream.problem() == "/tf: the frame 'a' in 'a' is ignored: it is its own parent"


def test_a_bus_without_transforms_says_so():
    stream = opened(FakeSource())
    assert stream.problem() == "no topic has transforms (tf2_msgs/TFMessage)"


def test_a_chain_of_thousands_of_frames_is_drawn(source):
    stream = opened(source)
    source.put("/tf", transforms(*(f"f{n:04} f{n + 1:04}" for n in range(3000))), 10.0)
    assert lines(stream)[-1][:2] == ["f3000", 3000]
