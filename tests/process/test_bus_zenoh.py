"""A bus that is Zenoh: nodes and commands, as on any other."""

import os
import socket
import sys
import threading
import time
from contextlib import closing, contextmanager

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.bus.url import parse_url
from lcmtools.bus.zenoh import sender
from lcmtools.bus.zenoh.bus import ZenohBus
from lcmtools.bus.zenoh.keep_last_sender import MOST_WAITING_BYTES
from lcmtools.bus.zenoh.observer import ZenohObserver
from lcmtools.bus.zenoh.sender import ZenohSender
from lcmtools.bus.zenoh.session import ZenohSession
from lcmtools.graph.protocol import NODE_CHANNEL, PROBE_CHANNEL, Probe, encode_probe
from lcmtools.labs.nodes.talker import Talker
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.stamp import Origin

# The handler runs while the session, which hears itself, holds its lock.
_PUBLISHES_IN_A_HANDLER = """
import os, signal, sys
from lcmtools.bus.url import parse_url
from lcmtools.bus.zenoh.observer import ZenohObserver
observer, handled = ZenohObserver(parse_url(os.environ["LCM_DEFAULT_URL"])), []
def handle(*_):
    if len(handled) < 5:
        handled.append(observer.send("/signal", bytes(8)))
def trace(frame, event, _):
    if frame.f_code.co_name == "_arrive" and event == "line" and "arrived" in frame.f_locals:
        signal.raise_signal(signal.SIGALRM)
    return trace
signal.signal(signal.SIGALRM, handle)
sys.settrace(trace)
observer.send("/a", bytes(8))
sys.settrace(None)
found = []
while len(found) < 6:
    found += observer.receive(1.0)
observer.close()
"""


@pytest.fixture
def bus_url(free_port, monkeypatch):
    """A bus of Zenoh that belongs to this test alone and stays on this computer."""
    monkeypatch.setenv("LCM_DEFAULT_URL", f"zenoh://224.0.0.224:{free_port()}")
    return os.environ["LCM_DEFAULT_URL"]


@contextmanager
def _listening(url):
    """A listener that all others know of: they have answered it."""
    with ZenohObserver(url) as listener:
        listener.send(PROBE_CHANNEL, encode_probe(Probe()))
        while listener.is_awaiting or listener.receive(0.0):
            listener.receive(0.1)
        yield listener


def _receive(listener, count):
    packets = []
    while len(packets) < count:
        packets += listener.receive(20.0)
    return packets


def test_zenoh_carries_channels_of_any_name(bus_url):
    url, heard = parse_url(bus_url), []
    names = ["/a/b", "EXAMPLE", "odom#nav_msgs.Odometry", "a *?$ b", "@x", "/", "ä"]
    with closing(ZenohBus(url)) as bus, _listening(url) as listener:
        for name in names:
            bus.subscribe(name, lambda payload, _: heard.append(payload))
            bus.publish(name, name.encode())
        packets = _receive(listener, len(names))
    assert [packet.channel for packet in packets] == names
    assert heard == [name.encode() for name in names]


def test_a_large_message_overtakes_no_small_ones_of_its_topic(bus_url, monkeypatch):
    url, has_room = parse_url(bus_url), threading.Event()
    put = ZenohSender._put

    def put_when_there_is_room(own, message):
        if threading.current_thread().name == "keep-last sender" and not message.is_bulk:
            has_room.wait(20.0)
        put(own, message)
        own._is_slow = True  # from now on small ones wait, too

    with closing(ZenohBus(url)) as bus, _listening(url) as listener:
        bus.publish("a", b"first")
        monkeypatch.setattr(ZenohSender, "_put", put_when_there_is_room)
        bus.publish("a", b"second")
        for payload in (b"third", bytes(MOST_WAITING_BYTES + 1)):
            bus.publish("a", payload)
        packets = _receive(listener, 2)
        assert not listener.receive(0.3)  # the large one waits
        has_room.set()
        packets += _receive(listener, 2)
    assert [len(packet.payload) for packet in packets] == [5, 6, 5, MOST_WAITING_BYTES + 1]


def test_zenoh_says_who_sent_what(bus_url):
    url = parse_url(bus_url)
    with ZenohObserver(url) as bus, _listening(url) as listener:
        bus.send("a", b"own")
        bus.send("a", b"relayed", Origin(7, 8, 2))
        own, relayed = _receive(listener, 2)
        assert own.sender == relayed.sender != listener.sender
        assert own.seqno is not None
        assert own.origin == Origin(int(own.sender.address, 16), own.seqno)
        assert relayed.origin == Origin(7, 8, 2)
        assert listener.numbered[own.sender].lost == 0


def test_commands_work_on_zenoh(cli, start_node):
    start_node(Talker, "__ns:=/a")
    chatter, talker = "/a/chatter", "/a/talker"
    for arguments, expected in (
        (("list",), f"{chatter}\n"),
        (("list", "-t"), f"{chatter} [std_msgs/String]\n"),
        (("type", chatter), "std_msgs/String\n"),
        (("info", chatter), f" * {talker} ("),
        (("echo", "-n", "1", chatter), 'data: "hello world'),
        (("node", "list"), f"{talker}\n"),
        (("node", "info", talker), f" * {chatter} [std_msgs/String]"),
        (("node", "ping", "-c", "1", talker), "/a/talker"),
        (("param", "list", talker), "use_sim_time"),
        (("param", "get", talker, "use_sim_time"), "alse"),
        (("hz", "-n", "3", chatter), "average rate: "),
        (("wtf",), "No errors or warnings"),
    ):
        assert expected in cli(*arguments).out, arguments


def test_recording_and_playing_work_on_zenoh(cli, start_node, tmp_path):
    start_node(Talker)
    log = str(tmp_path / "a.lcmlog")
    assert cli("bag", "record", "-o", log, "-n", "5", "/chatter").code == 0
    assert "/talker" in cli("bag", "info", log).ok()
    assert cli("bag", "play", log, "--ns", "/replay").code == 0


def test_a_late_list_is_complete_at_once(bus_url, start_node):
    """Sessions keep their nodes' announcements for who asks: no time has to pass."""
    for number in range(10):
        start_node(Talker, f"__ns:=/r{number}")
    with BusMonitor(parse_url(bus_url), "test", {}) as monitor:
        assert len(monitor.discover().nodes) == 10


def test_a_question_ends_when_all_have_answered(bus_url):
    """None is asked again and again until a timeout."""
    with closing(ZenohBus(parse_url(bus_url))), _listening(parse_url(bus_url)) as listener:
        for _ in range(3):
            listener.send(PROBE_CHANNEL, encode_probe(Probe()))
            while listener.is_awaiting:
                listener.receive(0.1)
            assert not any(listener.is_awaiting for _ in range(10))


def test_a_program_whose_address_another_one_has_ends_at_once(
    free_port, start_node, lcmtools_process, stopwatch
):
    url = f"zenoh://224.0.0.224:{free_port()}?listen=127.0.0.1:{free_port()}"
    start_node(Talker, url=url)
    watch = stopwatch()
    assert lcmtools_process("node", "list", "--lcm-url", url).stdout == "/talker\n"
    assert watch.seconds() < 8.0  # Zenoh itself closes after 10 s


def test_a_session_that_does_not_close_is_left(bus_url, monkeypatch, request):
    """As with a connection that cannot be made, because a line is full."""
    ends = threading.Event()
    request.addfinalizer(ends.set)
    close = ZenohSession._close_session

    def close_late(session):
        ends.wait(10.0)
        close(session)

    observer = ZenohObserver(parse_url(bus_url))
    monkeypatch.setattr(ZenohSession, "_close_session", close_late)
    closing = threading.Thread(target=observer.close)
    closing.start()
    closing.join(6.0)
    assert not closing.is_alive()


@pytest.mark.usefixtures("bus_url")
def test_a_signal_handler_may_publish_while_a_message_arrives(start_python):
    program = start_python(_PUBLISHES_IN_A_HANDLER)
    assert program.wait() == 0, program.output


def test_no_thread_sends_when_a_session_has_closed(bus_url, monkeypatch):
    """Python ends a thread that returns from Zenoh's code too late by aborting the process."""
    closed, put, close = threading.Event(), ZenohSender._put, ZenohSession._close_session

    def put_slowly(own, message):
        if message.is_bulk:
            closed.wait(20.0)
            time.sleep(0.2)  # it takes a moment to notice
        put(own, message)

    def close_and_tell(session):
        close(session)
        closed.set()

    observer = ZenohObserver(parse_url(bus_url))
    monkeypatch.setattr(ZenohSender, "_put", put_slowly)
    monkeypatch.setattr(ZenohSession, "_close_session", close_and_tell)
    observer.send("/image", bytes(10_000))
    observer.close()
    assert "keep-last sender" not in [thread.name for thread in threading.enumerate()]


def test_channels_without_end_fill_no_memory(bus_url, monkeypatch):
    monkeypatch.setattr(sender, "_MOST_PUBLISHERS", 10)
    with ZenohObserver(parse_url(bus_url)) as observer, _listening(parse_url(bus_url)) as listener:
        for number in range(25):
            observer.send(f"/reply_{number}", bytes(10_000), latched=True)  # may be late
        assert len(_receive(listener, 25)) == 25
        known = observer._session.sender
        assert len(known._publishers) <= 10
        assert len(known._bulk_keys) <= 10


def test_sessions_found_after_the_question_are_asked_too(bus_url, start_node):
    """On a busy computer, sessions find each other while the first answers come."""
    with _listening(parse_url(bus_url)) as listener:
        start_node(Talker)
        while all(packet.channel != NODE_CHANNEL for packet in listener.receive(0.1)):
            pass  # a session that is asked before its node is there has nothing to answer
        replies = []
        while listener.is_awaiting or not any(one.channel == NODE_CHANNEL for one in replies):
            replies += [packet for packet in listener.receive(0.1) if packet.seqno is None]


def test_dimos_program_is_heard_and_spoken_to(bus_url, cli, start_python, monkeypatch):
    """A plain program of Zenoh with dimos's keys: the type in the key, payloads as LCM has them."""
    group = bus_url.removeprefix("zenoh://")
    program = start_python(_DIMOS, group)
    program.wait_for("ready")
    monkeypatch.setenv("LCM_DEFAULT_URL", f"zenoh://{group}?prefix=dimos")
    assert cli("list", "-t").ok().splitlines() == [
        *("/cmd_vel [geometry_msgs/Twist]", "/odd [my_msgs/Odd]", "/where [geometry_msgs/Point]")
    ]
    assert cli("type", "/where").ok() == "geometry_msgs/Point\n"
    assert (
        "x: 1.0" in cli("echo", "-n", "1", "/cmd_vel/linear/x").out
        or cli("echo", "-n", "1", "/cmd_vel").ok()
    )
    assert cli("pub", "-1", "/goal", "std_msgs/String", "data: kitchen").code == 0
    assert program.wait_for("heard dimos/goal/std_msgs.String kitchen")


def test_zenoh_that_is_not_installed_is_told_in_one_line(cli, monkeypatch):
    monkeypatch.setitem(sys.modules, "zenoh", None)
    for name in ("opening", "session", "observer"):
        monkeypatch.delitem(sys.modules, f"lcmtools.bus.zenoh.{name}", raising=False)
    done = cli("list", "--lcm-url", "zenoh://")
    assert (done.code, done.out) == (3, "")
    install = "; type: pip install 'lcmtools-robotics[zenoh]'\n"
    assert_line(done.err, "lcmtools list: ", "extra 'zenoh'", "sys.modules", install)


@pytest.mark.parametrize(
    ("url", "fault"),
    [
        ("zenoh://127.0.0.1:1", "no Zenoh router or program at 127.0.0.1:1 (Connection refused)"),
        ("zenoh://?listen=192.0.2.1", "cannot listen at 192.0.2.1:7447"),
        ("zenoh:///nowhere.json5", "cannot read Zenoh's configuration '/nowhere.json5'"),
    ],
)
def test_zenoh_that_cannot_be_reached_is_explained(cli, url, fault):
    done = cli("list", "--lcm-url", url)
    assert (done.code, done.out) == (1, "")
    assert done.err.startswith(f"lcmtools list: {fault}")
    assert done.err.count("\n") == 1


def test_fault_of_a_zenoh_configuration_is_explained(cli, tmp_path):
    path = tmp_path / "a.json5"
    for text, fault in (
        ('{mode: "clint"}', "line 1: unknown variant `clint`"),
        ("{\n  connect:\n", "line 3: expected "),
        ("{nosuch: 1}", "line 1: unknown field `nosuch`"),
    ):
        path.write_text(text)
        done = cli("list", "--lcm-url", f"zenoh://{path}")
        assert (done.code, done.out) == (1, "")
        assert done.err.startswith(f"lcmtools list: cannot use {path}: {fault}"), done


def test_lost_connection_is_told_once_and_comes_back(free_port, wait_until):
    told = []
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    hub = parse_url(f"zenoh://224.0.0.224:{free_port()}?listen=127.0.0.1:{port}")
    url = parse_url(f"zenoh://127.0.0.1:{port}")
    first = ZenohBus(hub)
    with closing(ZenohBus(url)) as bus, closing(ZenohBus(url)) as other:
        bus.on_outage = told.append
        heard = []
        other.subscribe("a", lambda payload, _: heard.append(payload))
        first.close()
        wait_until(
            lambda: told == [f"the connection to {url} is lost; it is tried again until it is back"]
        )
        with closing(ZenohBus(hub)):
            wait_until(lambda: told[1:] == [f"the connection to {url} is back"])

            def is_heard():
                bus.publish("a", b"through the hub")
                return bool(heard)

            wait_until(is_heard)


def test_a_forked_process_leaves_zenoh_to_its_parent(bus_url, start_python):
    program = start_python(_FORKING, LCM_DEFAULT_URL=bus_url)
    assert program.wait() == 0
    assert_says(program.output, "Zenoh", "fork")
    assert program.output.splitlines()[-1] == "parent goes on"


_FORKING = """
import os, sys
import lcmtools
from lcmtools.types.std_msgs import String

lcmtools.init([])
publisher = lcmtools.Node("parent").create_publisher(String, "/a")
for has_node in (False, True):
    child = os.fork()
    if not child:
        if has_node:
            try:
                lcmtools.init([])
            except lcmtools.LcmtoolsError as error:
                print(error, flush=True)
        sys.exit(3)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 3
publisher.publish(String())
print("parent goes on", flush=True)
"""
_DIMOS = """
import json, sys, time
import zenoh
from lcmtools.types.geometry_msgs import Point, Twist
from lcmtools.types.std_msgs import String

config = zenoh.Config()
config.insert_json5("mode", '"peer"')
config.insert_json5("scouting/multicast/interface", '"lo"')
config.insert_json5("scouting/multicast/address", json.dumps(sys.argv[1]))

def hear(sample):
    print("heard", sample.key_expr, String.decode(sample.payload.to_bytes()).data, flush=True)

with zenoh.open(config) as session:
    keep = session.declare_subscriber("dimos/goal/std_msgs.String", hear)
    print("ready", flush=True)
    while True:
        session.put("dimos/cmd_vel/geometry_msgs.Twist", Twist().encode())
        session.put("dimos/where/geometry_msgs.Point", Point().encode())
        session.put("dimos/odd/my_msgs.Odd", b"12345678 no type that is known")
        time.sleep(0.05)
"""


def test_a_relay_hears_others_but_not_itself(bus_url):
    url = parse_url(bus_url)
    with ZenohObserver(url, is_relay=True) as relay, _listening(url) as other:
        relay.send("/own", b"1")
        assert [packet.channel for packet in _receive(other, 1)] == ["/own"]
        other.send("/theirs", b"2")
        heard = [packet.channel for packet in _receive(relay, 2)]
        assert heard == [PROBE_CHANNEL, "/theirs"]  # of the other one
