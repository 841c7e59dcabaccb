"""Properties that all forms of a picture have: they are valid whatever things are called."""

import re
import shutil
import subprocess
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.graph.drawing import as_json, dot, mermaid
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation
from lcmtools.graph.drawing.labels import printable
from lcmtools.graph.drawing.subgraph import members_only

_HOSTILE = [
    'a"b',
    "back\\slash",
    "end\\",
    "new\nline",
    "<b>&amp;&lt;",
    "#35;",
    "%%comment",
    "`md`",
    "1. list",
    "- item",
    "日本語",
    "\udcff\udc80",
    "😀",
    "",
    "end",
    "*bold* _em_",
    "\x00\x1b[31m",
    "|pipe|",
    '"];x',
    "-->",
    "]]>",
    "\\N \\G",
    "\ufffe",
]
_NAME = st.one_of(
    st.sampled_from(_HOSTILE),
    st.binary(max_size=63).map(lambda name: name.decode("utf-8", "surrogateescape")),
)
_DOT_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[\w.]+|->|[{}\[\];,=]|\s+')
_MERMAID = re.compile(
    r"flowchart LR"
    r'|  (?:  )?n\d+\(\["[^"]*"\]\):::(?:node|program|stale)'
    r'|  (?:  )?t\d+\["[^"]*"\]:::topic'
    r'|  (?:  )?s\d+\{\{"[^"]*"\}\}:::service'
    r'|  [nts]\d+ (?:-->|-\.->)(?:\|"[^"]*"\|)? [nts]\d+'
    r'|  subgraph g\d+\["[^"]*"\]|  end|  classDef .*'
)
_PICTURES = pytest.mark.parametrize("write", [dot.write, mermaid.write], ids=["dot", "mermaid"])


def diagram_of(names):
    """A node that publishes topics of these names, and a program of such a name that subscribes."""
    members = (Member("n1", "/a", pid=1), Member("n2", "".join(names), is_node=False))
    edges = [Edge("n1", f"t{n}", Relation.PUBLISHES, 3, 9.0) for n in range(len(names))]
    edges += [Edge(f"t{n}", "n2", Relation.SUBSCRIBES) for n in range(len(names))]
    channels = (Channel(f"t{n}", name, ("a/B",)) for n, name in enumerate(names))
    return Diagram(members, tuple(channels), tuple(edges))


def dot_tokens(document):
    """The words of a document in dot; fails where there is anything else."""
    found, end = [], 0
    for match in _DOT_TOKEN.finditer(document):
        assert match.start() == end, document[end : match.start()]
        end = match.end()
        found.append(match[0])
    assert end == len(document)
    return [token for token in found if token.strip()]


def dot_labels(document):
    """The first line of each vertex's label as Graphviz would show it."""
    tokens = dot_tokens(document)
    found = {}
    for place, word in enumerate(tokens):
        is_vertex = tokens[place - 3] != "->" and re.fullmatch(r"[nts]\d+", tokens[place - 2])
        if word == "label" and is_vertex:
            rows = re.split(r"(?<!\\)(?:\\\\)*\\n", tokens[place + 2][1:-1])
            found[tokens[place - 2]] = rows[0]
    return found


def read_dot(text):
    """Text between quotes, as Graphviz shows it."""
    return re.sub(r"\\(.)", r"\1", text).replace("&amp;", "&")


def read_mermaid(text):
    """Text between quotes, as Mermaid shows it."""
    return re.sub(r"#(\d+);", lambda match: chr(int(match[1])), text)


@settings(deadline=None, max_examples=50)
@given(st.lists(_NAME, max_size=4))
def test_dot_shows_every_name_as_it_is(names):
    labels = dot_labels(dot.write(diagram_of(names)))
    for number, name in enumerate(names):
        if "\\" not in name and "\\" not in printable(name):  # where a label's lines end is certain
            assert read_dot(labels[f"t{number}"]) == printable(name)


@pytest.mark.parametrize("name", _HOSTILE)
def test_dot_quotes_backslashes_quotes_and_entities(name):
    document = dot.write(diagram_of([name]))
    dot_tokens(document)
    escaped = printable(name).replace("\\", "\\\\").replace('"', '\\"').replace("&", "&amp;")
    assert f'label="{escaped}\\na/B"' in document


@pytest.mark.skipif(shutil.which("dot") is None, reason="needs Graphviz")
def test_graphviz_reads_it(draw):
    grouped = draw("/r/a > /r/t1 > /b", changes={"/b": {"stale": "x"}}, is_grouped=True)
    for diagram in (Diagram(), grouped, diagram_of(_HOSTILE), members_only(diagram_of(_HOSTILE))):
        command = [shutil.which("dot") or "dot", "-Tplain"]
        result = subprocess.run(
            command, input=dot.write(diagram).encode(), capture_output=True, check=False
        )
        assert (result.returncode, result.stderr) == (0, b"")


@settings(deadline=None, max_examples=50)
@given(names=st.lists(_NAME, max_size=4), is_grouped=st.booleans(), is_direct=st.booleans())
def test_mermaid_shows_every_name_as_it_is(names, *, is_grouped, is_direct):
    diagram = replace(diagram_of(names), is_grouped=is_grouped)
    document = mermaid.write(members_only(diagram) if is_direct else diagram)
    rows = document.splitlines()
    assert rows[0] == "flowchart LR"
    for row in rows:
        assert _MERMAID.fullmatch(row), row
    for number, name in enumerate(names if not is_direct else []):
        (row,) = [row for row in rows if row.strip().startswith(f"t{number}[")]
        shown = row.partition('"')[2].partition("<br/>")[0]
        assert not set(shown) & set('"<>`*|&')
        assert read_mermaid(shown) == printable(name)


def test_what_markdown_would_take_for_its_own_is_an_entity_in_mermaid():
    document = mermaid.write(diagram_of(["1. a", "- a", "_a_ a_b", "a*b", "`a`", "#35;"]))
    for shown in ("#49;. a", "#45; a", "#95;a#95; a_b", "a#42;b", "#96;a#96;", "#35;35#59;"):
        assert f'["{shown}<br/>' in document


def test_mermaid_in_markdown_is_a_block():
    assert mermaid.fenced("flowchart LR\n") == "```mermaid\nflowchart LR\n```\n"


def test_dot_marks_programs_stale_nodes_and_calls(draw):
    changes = {"/a": {"is_node": False}, "/b": {"stale": "ended"}, "/t": {"is_service": True}}
    diagram = draw("/a > /t > /b", changes=changes)
    edges = (replace(diagram.edges[0], relation=Relation.CALLS), diagram.edges[1])
    program, stale, service, call, _, _ = dot.write(replace(diagram, edges=edges)).splitlines()[5:]
    assert 'shape=ellipse, style=dashed, color="#616161"' in program
    assert 'fontcolor="#c62828"' in stale
    assert "(stale)" in stale
    assert "stale: ended" in stale  # in the tip
    assert "shape=hexagon" in service
    assert "style=dashed" in call


def test_dot_tips_have_types_and_counts(draw):
    changes = {"/t": {"messages": 5}, "/a": {"command": "run it"}}
    document = dot.write(draw("/a > /t > /b", changes=changes))
    assert r'tooltip="/t\ntype: a/B\nmessages: 5"' in document
    assert r"\ncommand: run it" in document


@_PICTURES
def test_rates_and_frames_are_shown(write, draw):
    diagram = draw("/r/a > /r/t > /b", is_grouped=True)
    edges = (replace(diagram.edges[0], rate=12.34), diagram.edges[1])
    document = write(replace(diagram, edges=edges))
    assert "12.3 Hz" in document
    assert re.search(r"(cluster_1|subgraph g1)", document)


@_PICTURES
def test_many_topics_between_two_are_cut(write, draw):
    diagram = members_only(draw(*(f"/a > /t{number} > /b" for number in range(10, 16))))
    document = write(diagram)
    assert "/t12" in document
    assert "and 3 more" in document


def test_json_has_its_keys_for_everything(draw):
    changes = {
        "/a": {"host": "h", "command": "c"},
        "/x": {"is_node": False, "listens": True},
        "/b": {"stale": "ended"},
        "/t": {"messages": 2, "rate": 1.5},
    }
    document = as_json.write(draw("/a > /t > /b", "/b > /t2 > /a", "/x", changes=changes))
    node = {
        "id": "n1",
        "node": "/a",
        "observed": False,
        "host": "h",
        "pid": 1,
        "command": "c",
        "user": None,
        "stale": None,
        "tool": False,
        "listens": False,
    }
    nodes = document["nodes"]
    assert isinstance(nodes, list)
    assert nodes[0] == node
    assert nodes[1]["stale"] == "ended"
    assert (nodes[2]["node"], nodes[2]["observed"], nodes[2]["listens"]) == (None, True, True)
    assert document["topics"] == [
        {"id": "t1", "topic": "/t", "types": ["a/B"], "messages": 2, "rate": 1.5},
        {"id": "t2", "topic": "/t2", "types": ["a/B"], "messages": 0, "rate": None},
    ]
    assert document["services"] == []
    edges = document["edges"]
    assert isinstance(edges, list)
    assert edges[0] == {
        "from": "n1",
        "to": "t1",
        "kind": "publishes",
        "messages": 0,
        "rate": None,
        "topics": [],
    }
    assert document["cycles"] == [["n1", "t1", "n2", "t2"]]


def test_nothing_is_a_document_in_every_form():
    assert as_json.write(Diagram()) == {
        "nodes": [],
        "topics": [],
        "services": [],
        "edges": [],
        "cycles": [],
    }
    assert dot_tokens(dot.write(Diagram()))[-1] == "}"
    assert mermaid.write(Diagram()).startswith("flowchart LR\n  classDef")
