"""``lcmtools.observe.messages``: what a notebook and a test see of a bus and of a log."""

import os
import signal
import socket
from contextlib import closing
from itertools import islice

import lcm
import pytest
from fixtures.says import raises_saying

import lcmtools
from lcmtools.errors import DecodeError, LcmtoolsError, NothingReceived, UsageError
from lcmtools.labs.nodes.talker import Talker
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Int32, String

MESSAGES = 30
START_US = 1_700_000_000_000_000


@pytest.fixture
def log(tmp_path):
    """A log with numbers at 100 Hz on /n, texts on /a/s, and bytes of no type on RAW."""
    path = tmp_path / "a.log"
    with closing(lcm.EventLog(str(path), "w", overwrite=True)) as events:
        for number in range(MESSAGES):
            value, text = Int32(), String()
            value.data, text.data = number, f"text {number}"
            events.write_event(START_US + 10_000 * number, "/n", encode(value))
            events.write_event(START_US + 10_000 * number, "/a/s", encode(text))
        events.write_event(START_US, "RAW", bytes(20))
    return path


def test_a_log_gives_its_messages_with_the_times_of_their_recording(log):
    arrivals = list(lcmtools.observe.messages("n", log=log))
    assert [arrival.message.data for arrival in arrivals] == list(range(MESSAGES))
    assert arrivals[1].time == START_US * 1000 + 10_000_000
    assert {(arrival.topic, arrival.sender) for arrival in arrivals} == {("/n", "unknown sender")}


def test_an_expression_and_a_pattern_choose_messages(log):
    found = lcmtools.observe.messages("/n", log=str(log), where="m.data >= 28")
    assert [arrival.message.data for arrival in found] == [28, 29]
    found = lcmtools.observe.messages("/n", "/**", log=log)
    assert [arrival.topic for arrival in found] == ["/n", "/a/s"] * MESSAGES


def test_what_is_wrong_is_an_error(log):
    with raises_saying(LcmtoolsError, "nothing on /m", "; ", "/a/s, /n, RAW"):
        list(lcmtools.observe.messages("/m", log=log))
    with pytest.raises(UsageError, match="no topic is named"):
        lcmtools.observe.messages(log=log)
    with raises_saying(UsageError, "url", "log"):
        lcmtools.observe.messages("/n", log=log, url="memq://")
    with pytest.raises(LcmtoolsError, match="cannot read the log"):
        list(lcmtools.observe.messages("/n", log=log.with_name("none")))


def test_what_cannot_be_decoded_is_an_error_unless_it_is_taken(log):
    (odd,) = lcmtools.observe.messages("RAW", log=log, undecoded=True)
    assert odd.payload == bytes(20)
    with pytest.raises(DecodeError, match="unknown type"):
        _ = odd.message
    with pytest.warns(UserWarning, match="a message is left out: RAW: unknown type"):
        assert list(lcmtools.observe.messages("RAW", log=log, where="m.data > 0")) == []
    errors = []
    assert list(lcmtools.observe.messages("RAW", log=log, on_error=errors.append)) == []
    assert len(errors) == 1


def test_a_bus_gives_messages_as_they_come_with_their_senders(bus_url, start_node, capsys):
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    start_node(Talker, "__ns:=/a")
    start_node(Talker, "__ns:=/b")
    with closing(lcmtools.observe.messages("/*/chatter", url=bus_url, timeout=10)) as arrivals:
        found = list(islice(arrivals, 20))
    assert {(one.topic, one.sender) for one in found} == {
        ("/a/chatter", "/a/talker"),
        ("/b/chatter", "/b/talker"),
    }
    assert all(one.message.data.startswith("hello world") for one in found)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == handlers
    assert capsys.readouterr() == ("", "")


def test_nothing_is_missed_that_is_sent_after_the_call(bus_url):
    with closing(lcmtools.observe.messages("EXAMPLE", url=bus_url, timeout=10)) as arrivals:
        sender = lcm.LCM(bus_url)
        sender.publish("EXAMPLE", encode(String()))
        arrival = next(arrivals)
    assert (arrival.topic, type(arrival.message)) == ("EXAMPLE", String)
    assert arrival.sender.endswith(f"(pid {os.getpid()})")


def test_a_bus_where_nothing_comes_is_given_up_and_left(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    sockets = []
    make = socket.socket.__init__

    def note(self, *args, **options):
        sockets.append(self)
        make(self, *args, **options)

    monkeypatch.setattr(socket.socket, "__init__", note)
    with pytest.raises(NothingReceived, match=r"nothing came on /a within 0\.1 s"):
        next(lcmtools.observe.messages("/a", timeout=0.1))
    lcmtools.observe.messages("/a").close()
    assert sockets
    assert all(one.fileno() == -1 for one in sockets)
