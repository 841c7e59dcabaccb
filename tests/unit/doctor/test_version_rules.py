"""Nodes of other versions: named, with what to update, and never taken for stale."""

import pytest

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.rules import examine
from lcmtools.doctor.sentences import describe
from lcmtools.graph.model import VERSION, Graph, Node

_NODE = Node("/driver", "id", "robot", 7, last_announced=1)
_OLD = _NODE._replace(version=VERSION - 1, software="lcmtools 0.0.9")
_NEW = _NODE._replace(name="/arm", id="b", version=VERSION + 1, software="lcmtools 9.0.0")


def _judged(*nodes):
    found = examine(Evidence("udpm://", graph=Graph(nodes)))
    (finding,) = [one for one in found if one.rule == "other-version"] or [None]
    if finding is None:
        return ()
    title, items, remedies = describe(finding)
    return (title, *items, *remedies)


@pytest.mark.parametrize(
    ("node", "named", "remedy"),
    [
        (_OLD, f"version {VERSION - 1} (lcmtools 0.0.9)", "update lcmtools where /driver runs"),
        (_NEW, f"version {VERSION + 1} (lcmtools 9.0.0)", "update the lcmtools that wtf was"),
        (_NEW._replace(has_details=False), "only name and process can be read", "update the"),
    ],
)
def test_a_node_of_another_version_is_named_with_the_side_to_update(node, named, remedy):
    title, item, *remedies = _judged(_NODE, node)
    assert f"({VERSION})" in title
    assert f"{node.name} (pid 7 on robot)" in item
    assert named in item
    assert len(remedies) == 1
    assert remedies[0].startswith(remedy)


def test_several_older_nodes_have_one_remedy():
    *_, remedy = _judged(_OLD, _OLD._replace(name="/arm", id="c"))
    assert remedy == "update lcmtools where /driver, /arm run"


def test_nodes_of_this_version_are_not_named():
    assert _judged(_NODE) == ()
