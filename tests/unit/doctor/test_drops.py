"""Drops of full buffers, told from those of filters."""

from lcmtools.bus.sockets import UdpSocket
from lcmtools.doctor.receivers import BufferDrops

PLAIN, NODE, OTHER = 1, 2, 3


def rows(*drops, queued=0):
    """The sockets of a plain program and of two nodes, of which the first has a queue."""
    table = {
        inode: UdpSocket("239.255.76.67", 7667, inode, 1000, count)
        for inode, count in zip((PLAIN, NODE, OTHER), drops, strict=True)
    }
    table[NODE] = table[NODE]._replace(queued_bytes=queued)
    return table


def drops(overflows, queued):
    """Those of a look in which each socket has counted some."""
    return BufferDrops(rows(5, 100, 0), rows(12, 900, 50, queued=queued), {NODE, OTHER}, overflows)


def test_a_socket_without_a_filter_tells_its_drops_itself():
    assert drops(overflows=0, queued=0).of(PLAIN, None) == 7


def test_what_a_filter_drops_is_none():
    assert drops(overflows=7, queued=90_000).of(NODE, 100_000) == 0


def test_a_node_behind_its_messages_has_what_the_others_do_not_explain():
    found = drops(overflows=20, queued=90_000)
    assert (found.of(NODE, 100_000), found.of(OTHER, 100_000)) == (13, 0)


def test_a_socket_that_came_during_the_look_has_dropped_nothing():
    assert BufferDrops({}, rows(5, 6, 7), {NODE}, 9).of(PLAIN, None) == 0
