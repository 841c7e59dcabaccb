"""Parameters of launch files hold what roslaunch reads, which is PyYAML's value with rosparam's."""

import math
from textwrap import indent
from xml.sax.saxutils import escape

import pytest
import yaml
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import InvalidFile, ValueMismatch
from lcmtools.launch.plan_report import PLAN_ANSWERS
from lcmtools.messages.documents import parse_values
from lcmtools.messages.setting import ANY, read_setting, write_setting

NODE = '<node pkg="lcmtools" type="talker" name="t">{}</node>'
COSTMAP = """
plugins:
  - {name: static_layer, type: "costmap_2d::StaticLayer"}
  - {name: obstacle_layer, type: "costmap_2d::VoxelLayer", sources: [scan, 'no']}
footprint: [[-0.2, -0.1], [0.2, 0.1]]
"""
MERGED = """
defaults: &defaults {rate: 5, frame: odom}
one: {<<: *defaults, frame: map}
two:
  rate: 1
  <<: *defaults
three: {rate: 1, rate: 2}
"""
VALUES = (
    *("yes", "No", "on", "OFF", "true", "FALSE", "'yes'", '"true"', "~", "null", "''", "'~'"),
    *("1", "-7", "017", "0x1F", "0b101", "1_000", "1:30", '"007"', "'1.10'", "1.5", ".5", "-2."),
    *("1.0e+3", ".inf", "-.INF", "word", "two words", "a/b.c", "'it''s'", r'"a\nb"', "10.0.0.1"),
    *("[1, [yes, '2']]", "!!str 5", "!!int '5'", "y"),
)


def parameters(plan):
    """The only node's parameters."""
    (node,) = plan.nodes
    return dict(node.parameters)


def rosparam(text):
    """A launch file with a text of YAML."""
    return f"<launch>{NODE.format(f'<rosparam>{escape(text)}</rosparam>')}</launch>"


@pytest.mark.parametrize("text", VALUES)
def test_values_are_those_of_pyyaml(plan, text):
    found = parameters(plan(rosparam(f"v: {text}\nlist: [{text}]")))
    expected = yaml.safe_load(text)
    assert repr(yaml.safe_load(found["v"])) == repr(expected)
    assert repr(yaml.safe_load(found["list"])) == repr([expected])


@pytest.mark.parametrize("text", [COSTMAP, MERGED], ids=["costmap", "merged"])
def test_nested_values_are_those_of_pyyaml(plan, text):
    expected = {}

    def unroll(value, name):
        if isinstance(value, dict):
            for key, part in value.items():
                unroll(part, f"{name}/{key}" if name else key)
        else:
            expected[name] = value

    unroll(yaml.safe_load(text), "")
    found = parameters(plan(rosparam(text)))
    assert {name: yaml.safe_load(value) for name, value in found.items()} == expected


def test_first_of_several_merged_mappings_wins(plan):
    """As in YAML's definition of "<<" and in ROS's PyYAML; versions since 6.0.3 differ."""
    text = "a: &a {x: 1}\nb: &b {x: 2, y: 2}\nc: {<<: [*a, *b]}"
    found = parameters(plan(rosparam(text)))
    assert (found["c/x"], found["c/y"]) == ("1", "2")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("deg(180)", math.pi),
        ("deg(-22.5)", math.radians(-22.5)),
        ("rad(pi/2)", math.pi / 2),
        ("rad(2*pi)", 2 * math.pi),
        ("rad(1.5)", 1.5),
    ],
)
def test_angles_of_rosparam_are_radians(plan, text, value):
    assert read_setting(parameters(plan(rosparam(f"v: {text}")))["v"], ANY, "v") == value
    assert parameters(plan(rosparam(f"v: '{text}'")))["v"] == f'"{text}"'


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("str", "2", "2"),
        ("string", " 007 ", "007"),
        ("String", "'a'", "'a'"),
        ("int", "2", 2),
        ("double", "2", 2.0),
        ("bool", "1", True),
        ("boolean", "False", False),
        ("auto", "2.5", 2.5),
        ("yaml", "[yes, 017]", [True, 15]),
    ],
)
def test_types_of_a_parameter(plan, kind, text, value):
    tag = f'<param name="v" type="{kind}" value="{text}"/>'
    found = read_setting(parameters(plan(f"<launch>{NODE.format(tag)}</launch>"))["v"], ANY, "v")
    assert (type(found), found) == (type(value), value)


@pytest.mark.parametrize(
    "text",
    ["[1, 2]", "{a: 1}", "a: b", "null", "~", "'quoted'", "#x", "- x", "yes", "[", "it's", "1 2"],
)
def test_a_value_without_a_type_is_a_number_a_truth_value_or_text(plan, text):
    tag = f'<param name="v" value="{escape(text)}"/>'
    value = parameters(plan(f"<launch>{NODE.format(tag)}</launch>"))["v"]
    assert read_setting(value, ANY, "v") == text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("""["1", 'true', "null", '~', "1.5", 5]""", ["1", "true", "null", "~", "1.5", 5]),
        ("""[ "a, b", 'it''s', "\\u0041", x]""", ["a, b", "it's", "A", "x"]),
        ("""- "1"\n- 2""", ["1", 2]),
        ("""- |\n  1\n- 2""", ["1\n", 2]),
    ],
)
def test_text_in_quotes_stays_text_in_a_list(plan, text, expected):
    value = parameters(plan(rosparam("v:\n" + indent(text, "  "))))["v"]
    assert read_setting(value, ANY, "v") == expected
    assert write_setting(expected) == value


@pytest.mark.parametrize("text", ["[[1, 2]]", "[{a: 1}]", "[1, ~]"])
def test_a_value_that_a_node_cannot_hold_is_noted(plan, text):
    found = plan(rosparam(f"v: {text}\nw: [1, a]"))
    (note,) = found.notes
    assert_says(note, "parameter v", "a node cannot hold it, and goes without it")
    with pytest.raises(ValueMismatch):
        read_setting(parameters(found)["v"], ANY, "v")


def test_yaml_of_a_parameter_may_be_a_mapping(plan):
    tag = '<param name="v" type="yaml" value="{p: 1, d: {i: no}}"/>'
    found = parameters(plan(f"<launch>{NODE.format(tag)}</launch>"))
    assert found == {"v/p": "1", "v/d/i": "false"}


def test_dump_shows_mappings(plan):
    records, rows = PLAN_ANSWERS["dump-params"](plan(rosparam(COSTMAP)), "")
    (record,) = records
    assert record["parameters"] == yaml.safe_load(COSTMAP)
    assert yaml.safe_load("\n".join(rows))["/t"] == yaml.safe_load(COSTMAP)


@pytest.mark.parametrize(
    ("tag", "place", "reason"),
    [
        ('<rosparam file=""/>', "a.launch:1", "'file' is empty in rosparam"),
        ('<rosparam command="foo"/>', "a.launch:1", "'command' must be load or dump or delete"),
        ("<rosparam>\n\na: {b: c: d}</rosparam>", "a.launch:3", "not YAML"),
        ('<rosparam>\na: !!binary "AAAA"</rosparam>', "a.launch:2", "binary data"),
        ("<rosparam>\na: deg(x)</rosparam>", "a.launch:2", "deg(x): not an angle"),
        ("<rosparam>\na: rad(q)</rosparam>", "a.launch:2", "rad(q): not an angle"),
        ("<rosparam>\na: {&lt;&lt;: 1}</rosparam>", "a.launch:2", "'<<' merges mappings only"),
        ('<rosparam file="p.yaml"/>', "p.yaml:2", "not YAML"),
    ],
)
def test_wrong_parameters_are_named_with_their_place(plan, folder, tag, place, reason):
    (folder / "p.yaml").write_text("a: 1\nb: *c\n")
    with raises_saying(InvalidFile, f"{place}: ", reason):
        plan(f"<launch>{NODE.format(tag)}</launch>")


def test_names_that_no_parameter_can_have_are_left_out_with_their_place(plan):
    found = plan(rosparam("\nkp: 1\njoints:\n  base-link: 2\n  '1': 3\n"))
    assert parameters(found) == {"kp": "1", "joints/1": "3"}
    (note,) = found.notes
    assert_says(note, "a.launch:4: ", "'joints/base-link' is not a legal name", "left out")


def test_own_yaml_stays_strict(plan):
    with raises_saying(InvalidFile, "a.yaml:4", "'rate' is given twice"):
        plan("nodes:\n- run: talker\n  param:\n   {rate: 1, rate: 2}\n", "a.yaml")
    assert parse_values(["a: yes"]) == {"a": "yes"}
