"""Programs that announce nothing and may be listening, from a socket table that is given."""

import pytest

from lcmtools.bus import listeners
from lcmtools.bus.listeners import PlainListeners
from lcmtools.bus.processes import Process, UdpSocket
from lcmtools.bus.url import parse_url

LOCAL = "udpm://239.255.76.67:7667?ttl=0"
OWN, OTHER_NODE, PLAIN = 1, 2, 3


class Computer:
    """The sockets of a bus by whose process they are, its nodes, and a clock."""

    def __init__(self):
        self.sockets = {100: OWN}
        self.nodes = {OWN}
        self.port = 7667
        self.time = 0.0
        self.looks = 0
        self.marked = frozenset()

    def udp_sockets(self):
        """The socket table."""
        self.looks += 1
        return [UdpSocket("239.255.76.67", self.port, inode, 0, 0) for inode in self.sockets]

    def owners(self, inodes):
        """Whose they are, but for the hidden ones."""
        found = {inode: self.sockets[inode] for inode in inodes}
        return {inode: Process(pid, "x") for inode, pid in found.items() if pid is not None}


@pytest.fixture
def computer(monkeypatch):
    made = Computer()
    monkeypatch.setattr(listeners, "udp_sockets", made.udp_sockets)
    monkeypatch.setattr(listeners, "owners", made.owners)
    monkeypatch.setattr(listeners, "marked_sockets", lambda *_: made.marked)
    return made


def watch(computer, url=LOCAL):
    return PlainListeners(parse_url(url), lambda: computer.nodes, lambda: computer.time)


def after(computer, listeners, seconds):
    """The answer after so long, when it was asked now and then."""
    for _ in range(round(seconds * 10)):
        computer.time += 0.1
        answer = listeners.possible()
    return answer


def test_where_only_nodes_listen_no_plain_program_can(computer):
    computer.sockets[200] = OTHER_NODE
    computer.nodes = {OWN, OTHER_NODE}

    assert watch(computer).possible() is False


@pytest.mark.parametrize("holder", [PLAIN, None], ids=["of this user", "hidden"])
def test_a_program_that_is_no_node_is_noticed_and_missed(computer, holder):
    plain = watch(computer)
    assert after(computer, plain, 3.0) is False

    computer.sockets[300] = holder
    assert after(computer, plain, 2.0) is True
    assert after(computer, plain, 5.0) is True
    del computer.sockets[300]
    assert after(computer, plain, 1.5) is False


def test_who_was_there_first_is_heard_from_the_start(computer):
    computer.sockets[300] = PLAIN
    plain = watch(computer)

    assert all(after(computer, plain, 0.1) for _ in range(30))


def test_a_plain_socket_of_a_process_that_is_a_node_counts(computer):
    computer.marked = frozenset({100})
    plain = watch(computer)
    assert plain.possible() is False

    computer.sockets[101] = OWN
    assert after(computer, plain, 1.2) is True
    del computer.sockets[101]
    assert after(computer, plain, 1.2) is False


def test_a_socket_that_goes_while_the_tables_are_read_counts_for_nothing(computer):
    computer.marked = frozenset({100})
    plain = watch(computer)
    assert plain.possible() is False

    computer.sockets[400] = PLAIN  # in the first table, and in the second one no more
    computer.time += 1.0
    assert plain.possible() is False
    del computer.sockets[400]
    assert after(computer, plain, 1.0) is False


def test_a_marked_socket_is_a_nodes_in_any_process(computer):
    computer.sockets[400] = PLAIN
    computer.marked = frozenset({100, 400})

    assert watch(computer).possible(at_once=True) is False


def test_a_look_at_once_counts_who_has_only_just_come(computer):
    plain = watch(computer)
    assert after(computer, plain, 3.0) is False
    assert plain.possible(at_once=True) is False

    computer.sockets[300] = PLAIN

    assert plain.possible() is False
    assert plain.possible(at_once=True) is True


def test_a_command_that_comes_and_goes_is_taken_for_none(computer):
    # Its socket is open a moment before it announces itself, and a moment after its goodbye.
    plain = watch(computer)
    assert plain.possible() is False
    for first in range(400, 420):
        computer.sockets[first] = PLAIN
        assert after(computer, plain, 0.4) is False
        del computer.sockets[first]
        assert after(computer, plain, 0.3) is False


def test_a_node_that_announces_itself_late_is_taken_for_none(computer):
    plain = watch(computer)
    computer.sockets[200] = OTHER_NODE
    plain.possible()
    computer.nodes = {OWN, OTHER_NODE}

    assert after(computer, plain, 3.0) is False


def test_a_node_that_says_goodbye_and_listens_on_is_a_plain_program(computer):
    computer.sockets[200] = OTHER_NODE
    computer.nodes = {OWN, OTHER_NODE}
    plain = watch(computer)
    assert after(computer, plain, 2.0) is False

    computer.nodes = {OWN}
    assert after(computer, plain, 2.0) is True


def test_sockets_of_other_buses_do_not_count(computer):
    plain = watch(computer, "udpm://239.255.76.67:7668?ttl=0")
    computer.port = 7668
    assert plain.possible() is False
    computer.port = 7667

    assert after(computer, plain, 2.0) is True  # not even its own: this system does not tell


@pytest.mark.parametrize(
    ("url", "answer"),
    [
        ("udpm://239.255.76.67:7667?ttl=1", True),
        ("tcpq://localhost:7700", True),
        ("memq://", False),
    ],
)
def test_a_bus_that_leaves_the_computer_may_always_be_heard_and_one_within_the_process_never(
    computer, url, *, answer
):
    assert after(computer, watch(computer, url), 2.0) is answer
    assert computer.looks == 0


def test_the_socket_table_is_read_once_a_second(computer):
    plain = watch(computer)

    after(computer, plain, 10.0)

    assert computer.looks <= 11
