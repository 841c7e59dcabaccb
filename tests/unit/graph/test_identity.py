"""Identities tell one node's announcements from another's without decoding them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement, head_of

NODE = NodeInfo(
    name="/husky0/driver",
    id="d41d8cd98f",
    host="husky",
    pid=1234,
    start_time=1_700_000_000_000_000_000,
    command="run driver",
    endpoints=(Endpoint("/husky0/odometry", Role.PUBLISHER, ("nav_msgs/Odometry",), (1,)),),
)


def identity(node=NODE, *, leaving=False, answers=0):
    return head_of(encode_announcement(Announcement(node, leaving, answers))).identity


def test_it_ends_with_the_id_and_the_state():
    assert identity().endswith(b"d41d8cd98f\0\0")


@pytest.mark.parametrize(
    "node", [NODE._replace(endpoints=()), NODE._replace(ports=(1, 2)), NODE._replace(command="x")]
)
def test_what_changes_in_a_nodes_life_does_not_change_it(node):
    assert identity(node) == identity()


def test_an_answer_to_a_probe_has_the_same():
    assert identity(answers=7) == identity()


@pytest.mark.parametrize(
    "node", [NODE._replace(id="other"), NODE._replace(name="/driver"), NODE._replace(pid=1)]
)
def test_another_node_has_another(node):
    assert identity(node) != identity()


def test_a_goodbye_has_another_so_that_it_is_not_lost_among_the_others():
    assert identity(leaving=True) != identity()


def test_what_is_no_announcement_has_none():
    assert head_of(b"\0" * 100) == (b"", b"")


@given(st.binary(max_size=200))
def test_damaged_announcements_are_survived(rest):
    start = encode_announcement(Announcement(NODE))[:8]
    assert isinstance(head_of(start + rest).identity, bytes)


def revision(node, *, leaving=False, answers=0):
    return head_of(encode_announcement(Announcement(node, leaving, answers))).revision


def counted(node):
    """The node after some messages."""
    (endpoint,) = node.endpoints
    later = endpoint._replace(messages=7, bytes=700, drops=1, last_time=9)
    return node._replace(endpoints=(later,))


def test_counters_leave_the_revision_as_it_is():
    assert len(revision(NODE)) == 8
    assert revision(counted(NODE)) == revision(NODE) == revision(NODE, answers=5)


@pytest.mark.parametrize(
    "node",
    [
        NODE._replace(endpoints=()),
        NODE._replace(endpoints=NODE.endpoints * 2),
        NODE._replace(endpoints=(NODE.endpoints[0]._replace(depth=2),)),
        NODE._replace(endpoints=(NODE.endpoints[0]._replace(types=("a/B",)),)),
        NODE._replace(ports=(40_000,)),
    ],
)
def test_whatever_else_changes_makes_a_new_revision(node):
    assert revision(node) != revision(NODE)
