"""A node's command line, in ROS's words and by flags."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.arguments import NodeArguments, looks_special, misspelt, split_arguments
from lcmtools.errors import UsageError


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["__ns:=/husky0"], NodeArguments(namespace="/husky0")),
        (["__ns:=husky0"], NodeArguments(namespace="husky0")),
        (["--ns", "/husky0"], NodeArguments(namespace="/husky0")),
        (["--ns=/husky0"], NodeArguments(namespace="/husky0")),
        (["__name:=bob"], NodeArguments(name="bob")),
        (["__node:=bob"], NodeArguments(name="bob")),
        (["--name", "bob"], NodeArguments(name="bob")),
        (["--name=bob"], NodeArguments(name="bob")),
        (["__name:=bob", "__name:=eve"], NodeArguments(name="eve")),
        (["_gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["--param", "gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["--param=gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["--param", "_gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["--param", "~gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["--param", "~/gain:=2.0"], NodeArguments(parameters={"gain": "2.0"})),
        (["_pid.kp:=2"], NodeArguments(parameters={"pid.kp": "2"})),
        (["--param", "pid.kp:=2"], NodeArguments(parameters={"pid.kp": "2"})),
        (["_a:=x:=y"], NodeArguments(parameters={"a": "x:=y"})),
        (["_a:={b: c}\nd"], NodeArguments(parameters={"a": "{b: c}\nd"})),
        (["_a:=1", "_a:=2"], NodeArguments(parameters={"a": "2"})),
        (["a:=b"], NodeArguments(remaps=(("a", "b"),))),
        (["/a/b:=c"], NodeArguments(remaps=(("/a/b", "c"),))),
        (["~a:=b"], NodeArguments(remaps=(("~a", "b"),))),
        (["--remap", "a:=b"], NodeArguments(remaps=(("a", "b"),))),
        (["--remap=a:=b"], NodeArguments(remaps=(("a", "b"),))),
        (["-r", "a:=b"], NodeArguments(remaps=(("a", "b"),))),
        (["-r=a:=b"], NodeArguments(remaps=(("a", "b"),))),
        (["-r", "__ns:=/x"], NodeArguments(namespace="/x")),
        (["-r", "_p:=1"], NodeArguments(parameters={"p": "1"})),
        (["a:=b", "a:=c"], NodeArguments(remaps=(("a", "b"), ("a", "c")))),
        (["--lcm-url", "memq://"], NodeArguments(lcm_url="memq://")),
        (
            ["--lcm-url=udpm://239.255.76.67:7667?ttl=0"],
            NodeArguments(lcm_url="udpm://239.255.76.67:7667?ttl=0"),
        ),
        (["--domain", "3"], NodeArguments(domain="3")),
        (["--domain=3"], NodeArguments(domain="3")),
        # an empty right side is taken away and ignored
        (["a:="], NodeArguments()),
        (["__ns:="], NodeArguments()),
        (["__name:="], NodeArguments()),
        (["_p:="], NodeArguments()),
        (["-r", "a:="], NodeArguments()),
        (["__unknown:="], NodeArguments()),
        # ROS's specials that mean nothing here
        (["__log:=/tmp/x", "__ip:=1.2.3.4", "__hostname:=h", "__master:=m"], NodeArguments()),
    ],
)
def test_everything_about_names_is_taken_out(words, said):
    assert split_arguments(words) == (said, [])


@pytest.mark.parametrize(
    "word",
    [
        ":=bar", "1foo:=bar", "foo", "-v", "--verbose", "foo=bar", "a b:=c", "é:=c", "", ":=", "-",
        "--names", "--nsx=/a", "--remapper", "-rx", "-ra:=b", "a:b=c", "--domains=3", "0.5",
        "[1,2]", "a\n:=b",
    ],
)  # fmt: skip
def test_everything_else_stays_where_it_was(word):
    said, rest = split_arguments(["first", word, "last"])
    assert said == NodeArguments()
    assert rest == ["first", word, "last"]


def test_taken_words_may_stand_anywhere():
    said, rest = split_arguments(["x", "a:=b", "y", "--ns", "/h", "z", "_p:=1"])
    assert rest == ["x", "y", "z"]
    assert said == NodeArguments(namespace="/h", remaps=(("a", "b"),), parameters={"p": "1"})


def test_nothing_is_taken_after_a_double_dash():
    said, rest = split_arguments(["a:=b", "--", "c:=d", "--ns", "--", "/x"])
    assert said == NodeArguments(remaps=(("a", "b"),))
    assert rest == ["--", "c:=d", "--ns", "--", "/x"]


@pytest.mark.parametrize(
    "flag", ["--ns", "--name", "--param", "--remap", "-r", "--lcm-url", "--domain"]
)
def test_a_flag_without_its_value_is_refused_with_an_example(flag):
    with pytest.raises(UsageError, match="needs a value") as caught:
        split_arguments(["x", flag])
    assert f"for example {flag} " in caught.value.hint


@pytest.mark.parametrize("flag", ["--param", "--remap", "-r"])
@pytest.mark.parametrize("value", ["a", "a=b", ":=b", "1a:=b", ""])
def test_a_flag_that_wants_an_assignment_says_so(flag, value):
    with pytest.raises(UsageError, match="expected two names with := between") as caught:
        split_arguments([flag, value])
    assert flag in caught.value.hint


def test_an_unknown_special_name_is_refused():
    with pytest.raises(UsageError, match="no such special name") as caught:
        split_arguments(["__nmae:=x"])
    assert "__ns, __name" in caught.value.hint


@given(st.lists(st.text(max_size=12) | st.sampled_from(["--ns", "-r", "a:=b", "--", "_x:=1"])))
def test_any_argument_list_is_refused_or_keeps_its_own_words_in_order(words):
    try:
        _, rest = split_arguments(words)
    except UsageError:
        return
    remaining = iter(words)
    assert all(word in remaining for word in rest)


@pytest.mark.parametrize(
    ("typed", "unknown", "hint"),
    [
        ("__ns=/husky0", "__ns=/husky0", "did you mean __ns:=/husky0?"),
        ("__ns:/husky0", "__ns:/husky0", "did you mean __ns:=/husky0?"),
        ("__ns:= /husky0", "/husky0", "did you mean __ns:=/husky0?"),
        ("a := b", "a", "did you mean a:=b?"),
        ("a :=b", "a", "did you mean a:=b?"),
        ("a = b", "a", "did you mean a:=b?"),
        ("a: =b", "a:", "did you mean a:=b?"),
        ("_kp=2", "_kp=2", "did you mean _kp:=2?"),
        ("kp=-0.5", "kp=-0.5", "did you mean _kp:=-0.5?"),  # no topic begins so
        ("loudly b", "loudly", ""),
        ("--fast=1", "--fast=1", ""),
        (":=b", ":=b", ""),
        ("--", "--", ""),
        ("image_view image:=/camera", "image_view", ""),
        ("x= image:=/camera", "x=", ""),
        ("a: --hold", "a:", ""),
        ("name value", "name", ""),
        ("--ros-args a:=b", "--ros-args", "names and remaps need none: leave it out"),
    ],
)
def test_an_assignment_that_is_misspelt_is_told(typed, unknown, hint):
    assert misspelt(typed.split(), unknown) == hint


@pytest.mark.parametrize(
    ("word", "expected"), [("__ns=/a", True), (":=b", True), ("a=b", False), ("--ns", False)]
)
def test_words_that_are_meant_for_every_node_can_be_told(word, *, expected):
    assert looks_special(word) is expected
