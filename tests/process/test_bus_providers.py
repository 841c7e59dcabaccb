"""Buses that are no multicast group: tcpq, logs, memory; and what listens on them."""

import os
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import lcm
import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.bus import preflight
from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.lcm_observer import LcmObserver
from lcmtools.bus.liblcm import open_lcm
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.sources import open_observer


def test_tcpq_carries_messages_of_any_size(tcpq_server, wait_until):
    url = parse_url(tcpq_server.url)
    bus, other = LcmBus(url), LcmBus(url)
    heard = []
    other.subscribe("a.b", lambda payload, _: heard.append(payload))
    bus.publish("PROBE", b"")
    while not heard:  # the server takes the subscription when it gets to it
        bus.publish("a.b", b"x")
        time.sleep(0.01)
    bus.publish("aXb", b"decoy")
    bus.publish("a.b", bytes(1_000_000))
    wait_until(lambda: heard[-1] == bytes(1_000_000))
    assert set(heard) == {b"x", bytes(1_000_000)}
    assert bus.ports == []
    bus.close()
    other.close()


def test_tcpq_sends_each_message_at_once(tcpq_server):
    """Nagle's algorithm holds a message back for 40 ms, and the answer to it as long again."""
    instance = open_lcm(parse_url(tcpq_server.url))
    with socket.socket(fileno=os.dup(instance.fileno())) as connection:
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_many_threads_may_use_tcpq_at_once(tcpq_server, wait_until):
    """Without a lock, liblcm mixes up their bytes."""
    bus, heard = LcmBus(parse_url(tcpq_server.url)), []
    bus.subscribe("a", lambda payload, _: heard.append(payload))

    def talk(number):
        for _ in range(1500):
            bus.publish("a", bytes([number]) * 50)

    def come_and_go():
        def handler(_payload, _time):
            """Hear, and do nothing."""

        for _ in range(100):
            bus.subscribe("b", handler)
            bus.unsubscribe("b", handler)

    with ThreadPoolExecutor(4) as threads:
        talkers = [threads.submit(talk, number) for number in range(3)]
        for busy in (*talkers, threads.submit(come_and_go)):
            busy.result(timeout=30)
    wait_until(lambda: len(heard) == 4500)
    assert {(len(payload), len(set(payload))) for payload in heard} == {(50, 1)}
    bus.close()


def test_no_tcpq_server_is_one_line_with_the_address(capfd, stopwatch):
    with socket.create_server(("127.0.0.1", 0)) as reserved:
        port = reserved.getsockname()[1]
    watch = stopwatch()
    for open_bus in (LcmBus, LcmObserver):
        with pytest.raises(BusError) as caught:
            open_bus(parse_url(f"tcpq://127.0.0.1:{port}"))
        assert_says(caught.value.what, "no LCM server", f"127.0.0.1:{port} (Connection refused)")
        assert f"lcmtools relay --serve tcpq://127.0.0.1:{port}" in caught.value.hint
    assert watch.seconds() < 1.0
    assert capfd.readouterr() == ("", "")


def test_a_server_that_says_nothing_is_one_line(monkeypatch):
    """As a computer does that hangs: it takes connections, and liblcm waits without end."""
    monkeypatch.setattr(preflight, "_ANSWER_TIMEOUT", 0.1)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        with raises_saying(BusError, "no LCM server", f"127.0.0.1:{port} (no answer)"):
            preflight.check_bus(parse_url(f"tcpq://127.0.0.1:{port}"))


def test_a_server_of_something_else_is_one_line():
    def answer(server):
        client, _ = server.accept()
        with client:
            client.sendall(b"SSH-2.0-")
            while client.recv(100):
                pass

    with ThreadPoolExecutor(1) as threads, socket.create_server(("127.0.0.1", 0)) as other:
        answering = threads.submit(answer, other)
        with pytest.raises(BusError, match=r"\(another program listens there\)"):
            preflight.check_bus(parse_url(f"tcpq://127.0.0.1:{other.getsockname()[1]}"))
        answering.result(timeout=40)


def test_an_unknown_tcpq_host_is_one_line():
    with raises_saying(BusError, "no LCM server", "no-such-host.invalid:7700"):
        LcmBus(parse_url("tcpq://no-such-host.invalid"))


@pytest.mark.parametrize("_turn", range(3))  # which thread notices first is a matter of luck
def test_a_tcpq_server_that_dies_hangs_nobody(tcpq_server, wait_until, stopwatch, _turn):
    bus = LcmBus(parse_url(tcpq_server.url))
    handler = lambda _payload, _time: None  # noqa: E731
    bus.subscribe("a", handler)
    tcpq_server.close()

    def refused():
        try:
            bus.publish("a", b"x")
        except BusError:
            return True
        return False

    wait_until(refused)
    watch = stopwatch()
    bus.unsubscribe("a", handler)
    with pytest.raises(BusError):
        bus.publish("a", b"x")
    bus.close()
    assert watch.seconds() < 1.0


def test_a_tcpq_server_that_is_back_is_used_again(tcpq_server, wait_until):
    url = parse_url(tcpq_server.url)
    with closing(LcmBus(url)) as bus:
        told = []
        bus.on_outage = told.append
        heard = []
        bus.subscribe("a", lambda payload, _: heard.append(payload))
        tcpq_server.close()
        wait_until(lambda: told)
        with pytest.raises(BusError, match=r"the connection to tcpq://.* is lost"):
            bus.publish("a", b"x")
        bus.subscribe("b", lambda payload, _: heard.append(payload))
        tcpq_server.reopen()
        wait_until(lambda: len(told) == 2)
        wait_until(lambda: _is_heard(bus, heard, b"again"))
        bus.publish("b", b"new")
        wait_until(lambda: b"new" in heard)
        lost, back = told
        assert_says(lost, str(url), "lost; ", "again")
        assert_says(back, str(url), "back")


def _is_heard(bus, heard, payload):
    try:
        bus.publish("a", payload)
    except BusError:
        return False
    return payload in heard


def test_a_bus_whose_server_is_gone_closes_at_once(tcpq_server, wait_until):
    bus, told = LcmBus(parse_url(tcpq_server.url)), []
    bus.on_outage = told.append
    tcpq_server.close()
    wait_until(lambda: told)
    bus.close()
    assert not bus._thread.is_alive()


def test_a_listener_on_tcpq_hears_everything(tcpq_server, wait_until):
    url = parse_url(tcpq_server.url)
    bus = LcmBus(url)
    with LcmObserver(url) as listener:
        heard = []

        def hear():
            bus.publish("A.b*", b"12345678rest")
            heard.extend(listener.receive(0.05))
            return bool(heard)

        before = time.time_ns()
        wait_until(hear)
        packet = heard[0]
        assert (packet.channel, packet.payload) == ("A.b*", b"12345678rest")
        assert packet.sender is None
        assert packet.seqno is None
        assert before <= packet.time <= time.time_ns()
        assert listener.port == 0
        assert listener.has_strangers, "plain programs show by their messages alone"
        listener.send("x", b"y")
    with pytest.raises(BusError):
        listener.send("x", b"y")
    bus.close()


def test_a_listener_hears_again_when_its_server_is_back(tcpq_server, wait_until):
    told = []
    url = parse_url(tcpq_server.url)
    with LcmObserver(url, lambda *what: told.append(what)) as listener:
        tcpq_server.close()
        wait_until(lambda: not listener.receive(0.01) and told)
        with pytest.raises(BusError, match=r"the connection to tcpq://.* is lost"):
            listener.send("x", b"y")
        tcpq_server.reopen()
        wait_until(lambda: not listener.receive(0.01) and len(told) == 2)
        with closing(LcmBus(url)) as bus:
            wait_until(lambda: bus.publish("a", b"new") or listener.receive(0.05))
        lost = f"the connection to {url} is lost; it is tried again until it is back"
        outage, (note, trouble) = told
        assert (outage, trouble) == ((lost, lost), "")
        assert_says(note, str(url), "back")
    with pytest.raises(EOFError):
        listener.receive(0.01)


def test_commands_that_look_go_on_when_the_server_is_back(tcpq_server, start, lcmtools_path):
    bus = {"LCM_DEFAULT_URL": tcpq_server.url}
    talker = start(lcmtools_path, "run", "talker", **bus)
    looking = start(lcmtools_path, "echo", "/chatter", **bus)
    looking.wait_for("data:")
    tcpq_server.close()
    for one, name in ((looking, "lcmtools echo: "), (talker, "")):
        one.wait_for(f"{name}the connection to {tcpq_server.url} is lost")
    tcpq_server.reopen()
    for one, name in ((looking, "lcmtools echo: "), (talker, "")):
        one.wait_for(f"{name}the connection to {tcpq_server.url} is back")
    looking.wait_for("data:")


@pytest.fixture
def log(tmp_path):
    """A log of five messages, 1 ms apart."""
    path = tmp_path / "a.log"
    with closing(lcm.EventLog(str(path), "w", overwrite=True)) as events:
        for number in range(5):
            events.write_event(1_700_000_000_000_000 + 1000 * number, "/n", b"%d" % number)
    return path


def test_a_listener_on_a_log_hears_all_of_it_and_then_its_end(log):
    payloads = []
    with LcmObserver(parse_url(f"file://{log}?speed=0")) as listener:
        while len(payloads) < 5:
            payloads += [packet.payload for packet in listener.receive(5.0)]
        assert payloads == [b"0", b"1", b"2", b"3", b"4"]
        listener.receive(5.0)
        with pytest.raises(EOFError):
            listener.receive(5.0)


def test_a_watch_on_a_log_sees_its_topics(log):
    with BusMonitor(parse_url(f"file://{log}?speed=0"), "list", {}) as watch:
        graph = watch.settle()
    assert graph.topic_names() == ["/n"]
    assert graph.topic("/n").traffic[0].messages == 5


@pytest.mark.parametrize("content", ["", "\n", "hello world, this is no log"])
def test_a_file_that_is_no_log_is_named(tmp_path, content, capfd):
    (tmp_path / "a.log").write_text(content)
    with raises_saying(BusError, "/a.log'", "not an LCM log"):
        LcmObserver(parse_url(f"file://{tmp_path}/a.log"))
    assert capfd.readouterr() == ("", "")


def test_a_log_that_is_not_there_is_named(tmp_path):
    for open_bus in (LcmBus, LcmObserver):
        with raises_saying(BusError, "cannot read", "/none.log'"):
            open_bus(parse_url(f"file://{tmp_path}/none.log"))


def test_a_bus_may_be_a_log_that_is_written(tmp_path):
    path = tmp_path / "new.log"
    bus = LcmBus(parse_url(f"file://{path}?mode=w"))
    bus.publish("/a", b"one")
    bus.publish("/b", bytes(1_000_000))
    bus.close()
    with closing(lcm.EventLog(str(path), "r")) as events:
        assert [(event.channel, event.data) for event in events] == [
            ("/a", b"one"),
            ("/b", bytes(1_000_000)),
        ]


def test_each_bus_gets_the_best_observer(bus_url):
    tap, listener = open_observer(parse_url(bus_url)), open_observer(parse_url("memq://"))
    assert isinstance(tap, Tap)
    assert isinstance(listener, LcmObserver)
    tap.close()
    listener.close()
