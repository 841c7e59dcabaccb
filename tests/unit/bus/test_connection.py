"""The times at which a lost connection is tried again."""

import pytest
from fixtures.says import assert_says

from lcmtools.bus import liblcm
from lcmtools.bus.liblcm import Connection
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError


class _Server:
    """A server that can be down, and a clock."""

    def __init__(self):
        self.is_up = True
        self.now = 10.0
        self.subscribed = 0
        self.outages = []

    def open(self, _url):
        if not self.is_up:
            raise BusError("it is down")
        return object()

    def subscribe(self, _instance):
        self.subscribed += 1

    def on_outage(self, text, trouble):
        self.outages.append((text, trouble))

    def pauses(self, connection, count):
        """The times that ``count`` attempts wait."""
        found = []
        for _ in range(count):
            left = connection.left()
            assert left is not None
            found.append(round(left, 3))
            self.now += left
            assert connection.left() == 0.0
            connection.try_again()
        return found


@pytest.fixture
def server(monkeypatch):
    """A server that liblcm connects to."""
    server = _Server()
    monkeypatch.setattr(liblcm, "open_lcm", server.open)
    monkeypatch.setattr(liblcm.time, "monotonic", lambda: server.now)
    return server


def _connection(server, url="tcpq://localhost:7700"):
    return Connection(parse_url(url), server.subscribe, server.on_outage)


def test_a_connection_that_works_waits_for_nothing(server):
    connection = _connection(server)
    assert (connection.is_lost, connection.left(), server.subscribed) == (False, None, 1)


def test_each_attempt_waits_twice_as_long_up_to_two_seconds(server):
    connection = _connection(server)
    server.is_up = False
    connection.lose()
    assert server.pauses(connection, 6) == [0.2, 0.4, 0.8, 1.6, 2.0, 2.0]
    assert connection.instance is None


def test_a_connection_that_is_back_subscribes_again_and_says_so(server):
    connection = _connection(server)
    server.is_up = False
    connection.lose()
    server.pauses(connection, 2)
    server.is_up = True
    server.pauses(connection, 1)
    assert (connection.is_lost, server.subscribed) == (False, 2)
    assert connection.instance is not None
    lost = "the connection to tcpq://localhost:7700 is lost; it is tried again until it is back"
    outage, (note, trouble) = server.outages
    assert outage == (lost, lost)
    assert_says(note, "tcpq://localhost:7700", "back")
    assert trouble == ""


def test_the_next_outage_begins_with_short_pauses_again(server):
    connection = _connection(server)
    server.is_up = False
    connection.lose()
    server.pauses(connection, 3)
    server.is_up = True
    server.pauses(connection, 1)
    connection.lose()
    assert server.pauses(connection, 1) == [0.2]


def test_a_log_that_has_ended_is_not_opened_again(server):
    connection = _connection(server, "file:///tmp/a.log")
    connection.lose()
    assert (connection.instance, connection.is_lost, server.outages) == (None, False, [])
