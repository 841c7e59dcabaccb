"""The words of ``args``, ``exec`` and ``run``, and arguments that are passed on."""

import pytest
import yaml
from fixtures.says import raises_saying

from lcmtools.errors import UsageError

ODD_WORDS = (
    *("print('hello world')", 'say "hi"', "it's", "", " ", "a b", "$HOME", "*", "\\", "--", "#x"),
    *("a\nb", "é", "'", '"', "`x`", "x;y"),
)


def words(plan):
    """The only node's command line."""
    (node,) = plan.nodes
    return list(node.command)


@pytest.mark.parametrize("word", ODD_WORDS)
def test_element_of_a_list_is_one_word(plan, word):
    text = yaml.safe_dump({"nodes": [{"exec": "true", "name": "t", "args": ["-c", word, "end"]}]})
    assert words(plan(text, "a.yaml")) == ["true", "-c", word, "end"]


def test_substitutions_stay_in_their_word(plan, folder):
    text = """
args: {what: "it's a \\"word\\""}
nodes: [{exec: "true", name: t, args: [$(arg what), "$(dirname)/x y", "$(eval 'a' + ' ' + 'b')"]}]
"""
    assert words(plan(text, "a.yaml"))[1:] == ['it\'s a "word"', f"{folder}/x y", "a b"]


def test_arguments_in_a_text_are_split(plan):
    text = "args: {more: -a 'b c'}\nnodes: [{exec: 'true', name: t, args: x $(arg more)}]"
    assert words(plan(text, "a.yaml")) == ["true", "x", "-a", "b c"]


@pytest.mark.parametrize("quotes", ["", "'", '"'])
def test_folder_with_a_blank_is_part_of_one_word(plan, folder, quotes):
    for name in ("node.py", "program"):
        (folder / name).write_text("#!/bin/sh\n")
        (folder / name).chmod(0o755)
    texts = [f"{quotes}$(dirname)/{name}{quotes} -v" for name in ("node.py", "program")]
    nodes = [{"run": texts[0], "name": "a"}, {"exec": texts[1], "name": "b"}]
    first, second = plan(yaml.safe_dump({"nodes": nodes}), "a.yaml").nodes
    assert first.command[:2] == (str(folder / "node.py"), "-v")
    assert second.command == (str(folder / "program"), "-v")


def test_folder_in_the_args_of_xml_is_one_word(plan, folder):
    node = '<node pkg="lcmtools" type="talker" name="t" args="$(dirname)/a.yaml -v"/>'
    assert words(plan(f"<launch>{node}</launch>"))[3:5] == [f"{folder}/a.yaml", "-v"]


def test_folder_in_an_expression_is_a_text_like_any_other(plan):
    text = "nodes: [{exec: 'true', name: t, args: \"$(eval dirname().split('/')[-1])\"}]"
    assert words(plan(text, "a.yaml")) == ["true", "my", "robot"]


INNER = """<launch><arg name="speed" default="1"/><arg name="robot" default="r"/>
<node pkg="lcmtools" type="talker" name="t" args="$(arg robot) $(arg speed)"/></launch>"""


@pytest.mark.parametrize(
    ("given", "expected"),
    [({}, ["r", "1"]), ({"speed": "2"}, ["r", "2"]), ({"speed": "2", "robot": "a"}, ["a", "2"])],
    ids=["none", "undeclared", "several"],
)
def test_all_arguments_are_passed_on_through_files(plan, folder, given, expected):
    (folder / "inner.launch").write_text(INNER)
    (folder / "middle.yaml").write_text("include: {file: inner.launch, pass_all_args: true}")
    outer = '<launch><include file="middle.yaml" pass_all_args="true"/></launch>'
    assert words(plan(outer, **given))[3:5] == expected


def test_argument_that_no_included_file_has_is_named(plan, folder):
    (folder / "inner.launch").write_text(INNER)
    outer = '<launch><include file="inner.launch" pass_all_args="true"/></launch>'
    with raises_saying(UsageError, "sped:=2", "inner.launch", "did you mean speed?"):
        plan(outer, sped="2")


@pytest.mark.parametrize("cwd", ["ROS_HOME", "ros_home", "Node", "node"])
def test_roslaunchs_folders_have_any_case(plan, cwd):
    node = f'<node pkg="lcmtools" type="talker" name="t" cwd="{cwd}"/>'
    assert plan(f"<launch>{node}</launch>").nodes[0].directory == ""
