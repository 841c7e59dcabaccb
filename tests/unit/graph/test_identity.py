"""What tells one node's announcements from another's without decoding them."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.graph.protocol import Announcement, encode_announcement, identity_in

NODE = Node(
    name="/husky0/driver",
    id="d41d8cd98f",
    host="husky",
    pid=1234,
    start_time=1_700_000_000_000_000_000,
    command="run driver",
    endpoints=(Endpoint("/husky0/odometry", Role.PUBLISHER, ("nav_msgs/Odometry",), (1,)),),
)


def identity(node: Node = NODE, *, leaving: bool = False, answers: int = 0) -> bytes:
    return identity_in(encode_announcement(Announcement(node, leaving, answers)))


def test_it_ends_with_the_id_and_the_state() -> None:
    assert identity().endswith(b"d41d8cd98f\0\0")


@pytest.mark.parametrize(
    "node", [replace(NODE, endpoints=()), replace(NODE, ports=(1, 2)), replace(NODE, command="x")]
)
def test_what_changes_in_a_nodes_life_does_not_change_it(node: Node) -> None:
    assert identity(node) == identity()


def test_an_answer_to_a_probe_has_the_same() -> None:
    assert identity(answers=7) == identity()


@pytest.mark.parametrize(
    "node", [replace(NODE, id="other"), replace(NODE, name="/driver"), replace(NODE, pid=1)]
)
def test_another_node_has_another(node: Node) -> None:
    assert identity(node) != identity()


def test_a_goodbye_has_another_so_that_it_is_not_lost_among_the_others() -> None:
    assert identity(leaving=True) != identity()


def test_what_is_no_announcement_has_none() -> None:
    assert identity_in(b"\0" * 100) == b""


@given(st.binary(max_size=200))
def test_damaged_announcements_are_survived(rest: bytes) -> None:
    start = encode_announcement(Announcement(NODE))[:8]
    assert isinstance(identity_in(start + rest), bytes)
