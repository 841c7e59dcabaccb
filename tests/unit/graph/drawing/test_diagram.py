"""Names of a picture's members, and text that anything can show."""

from xml.dom.minidom import parseString

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.drawing.diagram import Member, outermost
from lcmtools.graph.drawing.labels import names, notes, printable, title


@pytest.mark.parametrize(
    ("name", "expected"),
    [("/husky0/odometry", "/husky0"), ("/a/b/c", "/a"), ("/tf", ""), ("EXAMPLE", ""), ("a/b", "")],
)
def test_the_outermost_namespace(name, expected):
    assert outermost(name) == expected


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("/opt/x/bin/lcm-source -m EXAMPLE", "lcm-source -m EXAMPLE"),
        ("", "a program"),
        ("/usr/bin/python3 -u /home/ada/drive.py --fast", "drive.py --fast"),
        ("p " + "x" * 60, "p …"),
    ],
)
def test_a_program_is_called_by_its_name_and_arguments(command, expected):
    assert title(Member("n1", command, is_node=False)) == expected


def test_what_is_said_of_a_member():
    assert notes(Member("n1", "/a", host="here", pid=1)) == []
    assert notes(Member("n1", "/a", host="robot", is_here=False)) == ["on robot"]
    assert notes(Member("n1", "/a", stale="hangs")) == ["stale: hangs"]
    program = Member("n1", "x", is_node=False, pid=7, listens=True)
    assert notes(program) == ["no node, pid 7", "receives unknown channels"]


def test_two_nodes_of_the_same_name_stay_two(draw):
    diagram = draw("/a", "/x", "/b", changes={"/x": {"name": "/a", "pid": 5}})
    assert list(names(diagram).values()) == ["/a (pid 1)", "/a (pid 5)", "/b"]


def test_groups_are_the_outermost_namespaces_of_a_grouped_diagram(draw):
    words = ("/r/a > /r/t1 > /b", "X")
    assert draw(*words).groups() == {"": ["n1", "n2", "t1", "t2"]}
    assert draw(*words, is_grouped=True).groups() == {"/r": ["n1", "t1"], "": ["n2", "t2"]}


def test_a_program_stands_in_no_namespace(draw):
    program = {"/usr/bin/x": {"is_node": False}}
    assert draw("/usr/bin/x", changes=program, is_grouped=True).groups() == {"": ["n1"]}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/a_b/1 é 日本", "/a_b/1 é 日本"),
        ("a\nb\x1b", "a\\x0ab\\x1b"),
        ("\udcff", "\\xff"),
        ("\u202e", "\\u202e"),
        ("\ufffe", "\\ufffe"),
    ],
)
def test_what_cannot_be_shown_is_escaped(text, expected):
    assert printable(text) == expected


@given(st.binary(max_size=63))
def test_every_channel_is_printable_and_stands_in_xml(name):
    text = printable(name.decode("utf-8", "surrogateescape"))
    quoted = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    root = parseString(f"<a>{quoted}</a>").documentElement  # noqa: S318 - our own
    assert "".join(node.data for node in root.childNodes) == text
