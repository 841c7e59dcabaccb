"""The tree of lines."""

from dataclasses import replace

import pytest

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Relation
from lcmtools.graph.drawing.subgraph import members_only
from lcmtools.graph.drawing.text import ASCII, UNICODE, signs_for, write


def test_who_publishes_what_and_who_hears_it(draw):
    diagram = draw("/talker > /t1 > /b", "/t1 > /a", "/talker > /t2 > /a")
    assert write(diagram) == [
        "/talker",
        "├─ /t1 [a/B]",
        "│  ├→ /a",
        "│  └→ /b",
        "└─ /t2 [a/B]",
        "   └→ /a",
    ]


def test_data_flow_downwards_and_parts_stay_together(draw):
    diagram = draw("/c > /t3 > /d", "/b > /t2 > /c", "/a > /t1 > /b", "/x > /t9 > /y", "/alone")
    heads = [row for row in write(diagram) if row.startswith("/")]
    assert heads == ["/a", "/b", "/c", "/x", "/alone"]


def test_cycles_are_named(draw):
    rows = write(draw("/a > /t1 > /b > /t2 > /a", "/c > /t3 > /c"))
    assert rows[-3:] == [
        "",
        "cycle: /a → /t1 → /b → /t2 → /a",
        "cycle: /c → /t3 → /c",
    ]


def test_what_nobody_publishes_stands_at_the_end(draw):
    assert write(draw("/t > /a")) == ["(no publisher)", "└─ /t [a/B]", "   └→ /a"]


def test_services_are_marked(draw):
    service = Channel("s1", "/switch", ("std_srvs/SetBool",), is_service=True)
    diagram = replace(draw("/a"), channels=(service,), edges=(Edge("s1", "n1", Relation.SERVES),))
    assert write(diagram) == [
        "(no client announced)",
        "└─ /switch [std_srvs/SetBool] (service)",
        "   └→ /a",
    ]


def test_rates_stand_behind_the_type(draw):
    diagram = draw("/a > /t > /b")
    edges = (replace(diagram.edges[0], rate=9.96), diagram.edges[1])
    assert write(replace(diagram, edges=edges))[1] == "└─ /t [a/B] 10.0 Hz"


def test_notes_stand_in_brackets(draw):
    diagram = draw("/a > /t > /b", changes={"/b": {"stale": "hangs"}, "/a": {"is_here": False}})
    rows = write(diagram)
    assert rows[0] == "/a (on another computer)"
    assert rows[-1] == "   └→ /b (stale: hangs)"


def test_without_topics_they_stand_behind_the_hearer(draw):
    rows = write(members_only(draw("/a > /t1 > /b", "/a > /t2 > /b")))
    assert rows == ["/a", "└→ /b: /t1, /t2"]


def test_types_are_left_out_where_they_do_not_fit(draw):
    diagram = draw("/a > /t > /b")
    assert write(diagram, width=9)[1] == "└─ /t"
    assert write(diagram, width=11)[1] == "└─ /t [a/B]"


def test_ascii_alone(draw):
    program = {"is_node": False, "name": "x" * 50}
    rows = write(draw("/a > /t1 > /a", "/a > /t2 > /b", changes={"/b": program}), ASCII)
    assert "\n".join(rows).isascii()
    assert rows[:3] == ["/a", "|- /t1 [a/B]", "|  `> /a"]


def test_control_characters_are_escaped(draw):
    rows = write(draw("/a > /t > /b", changes={"/t": {"name": "x\n\x1b[2J\udcff"}}))
    assert rows[1] == "└─ x\\x0a\\x1b[2J\\xff [a/B]"


def test_nothing_for_nothing():
    assert write(Diagram()) == []


@pytest.mark.parametrize(
    ("encoding", "environment", "expected"),
    [
        ("utf-8", {"LANG": "de_DE.UTF-8"}, UNICODE),
        ("utf-8", {"LC_ALL": "C", "LANG": "de_DE.UTF-8"}, ASCII),
        ("utf-8", {"LC_ALL": "", "LANG": "C.UTF-8"}, UNICODE),
        ("latin-1", {"LANG": "de_DE"}, ASCII),
        (None, {"LANG": "de_DE.UTF-8"}, ASCII),
        ("utf-8", {}, ASCII),
    ],
)
def test_which_signs_a_terminal_shows(encoding, environment, expected):
    assert signs_for(encoding, environment) is expected
