"""Programs that announce nothing and may be listening, from a socket table that is given."""

import pytest

from lcmtools.bus.kernel import ANNOUNCED
from lcmtools.bus.sockets import PlainListeners, SocketTable, UdpSocket
from lcmtools.bus.url import parse_url

LOCAL = "udpm://239.255.76.67:7667?ttl=0"


class Computer:
    """The sockets of a bus, those of nodes, which are marked, and a clock."""

    def __init__(self):
        self.sockets = {100}
        self.marked = {100}
        self.port = 7667
        self.time = 0.0
        self.looks = 0

    def table(self):
        """The socket table."""
        self.looks += 1
        of_bus = "239.255.76.67", self.port
        table = SocketTable({inode: UdpSocket(*of_bus, inode, 0, 0) for inode in self.sockets}, {})
        table.marks = dict.fromkeys(self.marked, ANNOUNCED)
        return table


@pytest.fixture
def computer(monkeypatch):
    made = Computer()
    monkeypatch.setattr(SocketTable, "read", made.table)
    return made


def watch(computer, url=LOCAL):
    return PlainListeners(parse_url(url), lambda: computer.time)


def after(computer, listeners, seconds):
    """The answer after so long, when it was asked now and then."""
    for _ in range(round(seconds * 10)):
        computer.time += 0.1
        answer = listeners.possible()
    return answer


def test_where_only_nodes_listen_no_plain_program_can(computer):
    computer.sockets = computer.marked = {100, 200}

    assert watch(computer).possible(at_once=True) is False


def test_a_program_that_is_no_node_is_noticed_and_missed(computer):
    plain = watch(computer)
    assert after(computer, plain, 3.0) is False

    computer.sockets.add(300)
    assert after(computer, plain, 2.0) is True
    assert after(computer, plain, 5.0) is True
    computer.sockets.remove(300)
    assert after(computer, plain, 1.5) is False


def test_who_was_there_first_is_heard_from_the_start(computer):
    computer.sockets.add(300)
    plain = watch(computer)

    assert all(after(computer, plain, 0.1) for _ in range(30))


def test_a_socket_that_goes_while_the_tables_are_read_counts_for_nothing(computer):
    plain = watch(computer)
    assert plain.possible() is False

    computer.sockets.add(400)  # in the first table, and in the second one no more
    computer.time += 1.0
    assert plain.possible() is False
    computer.sockets.remove(400)
    assert after(computer, plain, 1.0) is False


def test_a_look_at_once_counts_who_has_only_just_come(computer):
    plain = watch(computer)
    assert after(computer, plain, 3.0) is False
    assert plain.possible(at_once=True) is False

    computer.sockets.add(300)

    assert plain.possible() is False
    assert plain.possible(at_once=True) is True


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


def test_where_sockets_have_no_marks_any_may_be_a_plain_programs(computer):
    computer.marked = set()
    assert after(computer, watch(computer), 2.0) is True
