"""Parameters are of their default's type."""

import pytest
from fixtures.says import raises_saying

from lcmtools import Node
from lcmtools.errors import UsageError
from lcmtools.node.parameters import Parametric


def _given(text, default):
    """The value of a parameter that the command line gives this text."""
    return Parametric("/a", {"p": text}, set()).declare_parameter("p", default).value


@pytest.mark.parametrize(
    ("text", "default", "value"),
    [
        ("2.5", 1.0, 2.5),
        ("2", 1.0, 2.0),
        ("-1e-3", 1.0, -0.001),
        ("1e3", 1.0, 1000.0),
        (".5", 1.0, 0.5),
        ("7", 1, 7),
        ("-7", 1, -7),
        ("true", False, True),
        ("False", True, False),
        ("text", "", "text"),
        ("2", "", "2"),
        ("true", "", "true"),
        ("'quoted'", "", "quoted"),
        ('"quoted"', "", "quoted"),
        ("it's", "", "it's"),
        ("the dogs'", "", "the dogs'"),
        ("a: b: c", "", "a: b: c"),
        ("[1, 2", "", "[1, 2"),
        ("/home/a b", "", "/home/a b"),
        ("été", "", "été"),
        ("[1, 2.5]", (0.0,), [1, 2.5]),
        ("[]", [1], []),
        ("2.5", None, 2.5),
        ("text", None, "text"),
        ("[1, a]", None, [1, "a"]),
    ],
)
def test_a_text_is_read_as_its_defaults_type(text, default, value):
    read = _given(text, default)
    assert read == value
    assert type(read) is type(value)


@pytest.mark.parametrize(
    ("text", "default", "expected"),
    [
        ("fast", 1.0, "a number"),
        ("true", 1.0, "a number"),
        ("[1]", 1.0, "a number"),
        ("2.5", 1, "an integer"),
        ("true", 1, "an integer"),
        ("two", 1, "an integer"),
        ("2", True, "true or false"),
        ("maybe", True, "true or false"),
        ("1", [2], "a list"),
        ("a: 1", [2], "a list"),
    ],
)
def test_a_text_of_another_type_is_refused(text, default, expected):
    with pytest.raises(UsageError, match=f"parameter p: expected {expected}, got "):
        _given(text, default)


def test_a_text_that_is_no_yaml_is_refused():
    with pytest.raises(UsageError, match=r"parameter p: bad YAML at line 1"):
        _given("[1, 2", [])


def test_the_command_line_beats_the_default(begin):
    begin("_gain:=2.5", "--param", "name:=bob")
    node = Node("a")
    assert node.declare_parameter("gain", 1.0).value == 2.5
    assert node.declare_parameter("name", "eve").value == "bob"
    assert node.declare_parameter("other", 3).value == 3
    assert node.get_parameter("gain").value == 2.5


def test_an_undeclared_parameter_is_refused_with_the_nearest(begin):
    begin()
    node = Node("a")
    node.declare_parameter("gain", 1.0)
    with pytest.raises(UsageError, match="/a has no parameter 'gian'") as caught:
        node.get_parameter("gian")
    assert caught.value.hint == "did you mean gain?"


def test_a_wrong_value_is_refused_when_it_is_declared(begin):
    begin("_gain:=high")
    with raises_saying(UsageError, "gain: ", "number", "'high'"):
        Node("a").declare_parameter("gain", 1.0)


def test_a_wrong_use_sim_time_is_refused(begin):
    begin("_use_sim_time:=2")
    with raises_saying(UsageError, "use_sim_time: ", "true", "false"):
        Node("a")
