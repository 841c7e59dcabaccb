"""Recording from a bus: what the logs have, and what becomes of them at any end."""

import json
import os
import re
import signal
import threading
from contextlib import closing, contextmanager

import lcm
import pytest
from fixtures.says import assert_says
from fixtures.typist import Typist

from lcmtools import Node
from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import BagRecorder, Limits, open_bus
from lcmtools.bag.ring import SnapshotPlan
from lcmtools.bag.series import LogSeries
from lcmtools.bus import multicast
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.find import GLOBAL
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.packages.user_types import source_text
from lcmtools.types.geometry_msgs import PointStamped
from lcmtools.types.std_msgs import Bool, String


@pytest.fixture
def path(tmp_path):
    return tmp_path / "ride.lcmlog"


@contextmanager
def _recording(
    url,
    path,
    topics=(),
    limits=Limits(),  # noqa: B008 - frozen
    snapshot=None,
    names=GLOBAL,
):
    split = limits.split_bytes is not None
    with (
        open_bus(parse_url(url), os.environ) as monitor,
        BagRecorder(
            monitor,
            RecordedTopics(topics, names),
            LogSeries(str(path), numbered=split),
            limits,
            snapshot,
        ) as recorder,
    ):
        yield recorder


def _publish(bus, channel, count, size=10):
    payloads = [number.to_bytes(4, "big") * (size // 4) for number in range(count)]
    for payload in payloads:
        bus.publish(channel, payload)
    return payloads


def _payloads(path, channel):
    with LogFile(path) as log:
        return [packet.payload for packet in log.packets() if packet.channel == channel]


def test_messages_of_plain_programs_and_nodes_are_recorded_with_their_senders(
    bus_url, path, start_node, wait_until
):
    plain = lcm.LCM(bus_url)
    with _recording(bus_url, path) as recorder:
        node = start_node(lambda: Node("driver"))
        publisher = node.node.create_publisher(PointStamped, "/goal")
        sent = _publish(plain, "EXAMPLE", 100)
        for _ in range(10):
            publisher.publish(PointStamped())
        wait_until(lambda: recorder.progress().messages >= 110)
    assert _payloads(path, "EXAMPLE") == sent
    with LogFile(path) as log:
        senders = {packet.channel: packet.sender for packet in log.packets()}
        names = {name: sender.name for name, sender in senders.items() if sender}
        assert names["/goal"] == "/driver"
        assert f"(pid {os.getpid()})" in names["EXAMPLE"]
        assert {"geometry_msgs/PointStamped", "geometry_msgs/Point", "std_msgs/Header"} <= set(
            log.index.types
        )
        kept = log.index.types["geometry_msgs/PointStamped"]
        assert kept.source.strip() == source_text(PointStamped)
        assert kept.path == "geometry_msgs/PointStamped.lcm"
        assert log.index.nodes
        assert log.index.size == path.stat().st_size
        assert all(loss.lost == 0 and loss.sent for loss in log.losses().values())


def test_lcm_reads_the_log(bus_url, path, wait_until):
    with _recording(bus_url, path) as recorder:
        sent = _publish(lcm.LCM(bus_url), "EXAMPLE", 50, size=1000)
        wait_until(lambda: recorder.progress().messages == 50)
    log = lcm.EventLog(str(path), "r")
    assert [(event.eventnum, event.channel, event.data) for event in log] == [
        (number, "EXAMPLE", payload) for number, payload in enumerate(sent)
    ]
    log.close()


@pytest.mark.usefixtures("private_network")
def test_bursts_of_large_messages_have_room_in_usual_buffers(path, wait_until, monkeypatch):
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 212_992)
    url = "udpm://239.255.76.67:7667?ttl=0"
    bus = lcm.LCM(url)
    with _recording(url, path) as recorder:
        assert len(recorder._monitor.tap._sockets.all) == 12
        sent = _publish(bus, "IMAGE", 2, size=1_000_000)
        _publish(bus, "LAST", 1)
        wait_until(lambda: _payloads(path, "LAST"))
    assert _payloads(path, "IMAGE") == sent


def test_files_are_split_and_begin_with_what_is_latched(bus_url, path, start_node, wait_until):
    node = start_node(lambda: Node("map_server"))
    publisher = node.node.create_publisher(String, "/map")
    publisher.is_latched = True
    with _recording(bus_url, path, limits=Limits(split_bytes=100_000)) as recorder:
        wait_until(lambda: "/map" in recorder._notes._latched)
        message = String()
        message.data = "map"
        publisher.publish(message)
        wait_until(lambda: recorder.progress().messages == 1)
        plain, sent = lcm.LCM(bus_url), []
        while (files := recorder.progress().files) < 3:
            sent += _publish(plain, "EXAMPLE", 100, size=1000)
            wait_until(lambda: recorder.progress().files > files)
    parts = [path.with_name(f"ride_{number}.lcmlog") for number in range(3)]
    assert [payload for part in parts for payload in _payloads(part, "EXAMPLE")] == sent
    for part in parts:
        with LogFile(part) as log:
            first = next(log.packets())
            assert first.channel == "/map"
            assert first.sender is not None
            assert first.sender.name == "/map_server"
            assert "std_msgs/String" in log.index.types
            assert log.index.nodes


def test_a_snapshot_has_what_came_before_and_after_it_was_wanted(
    bus_url, tmp_path, path, wait_until
):
    plain = lcm.LCM(bus_url)
    snapshot = SnapshotPlan(60.0, after=0.2, is_wanted=lambda packet: packet.channel == "STOP")
    with _recording(bus_url, path, snapshot=snapshot) as recorder:
        before = _publish(plain, "EXAMPLE", 5)
        wait_until(lambda: recorder.progress().kept_messages == 5)
        assert not list(tmp_path.glob("*.lcmlog"))
        _publish(plain, "STOP", 1)
        wait_until(lambda: recorder.progress().is_writing)
        after = _publish(plain, "EXAMPLE", 3)
        wait_until(lambda: recorder.progress().messages == 9)
        wait_until(lambda: not recorder.progress().is_writing)
        _publish(plain, "EXAMPLE", 1)
        wait_until(lambda: recorder.progress().kept_messages == 10)
        recorder.save()
        wait_until(lambda: recorder.progress().files == 2)
    assert _payloads(path, "EXAMPLE") == before + after
    assert len(_payloads(path.with_name("ride_1.lcmlog"), "EXAMPLE")) == 9


def test_a_recording_ends_by_the_bound_of_each_topic(bus_url, path):
    plain = lcm.LCM(bus_url)
    with _recording(bus_url, path, ("A", "B"), Limits(messages=3)) as recorder:
        _publish(plain, "A", 5)
        _publish(plain, "C", 5)
        assert not recorder.wait(0.1)
        _publish(plain, "B", 5)
        assert recorder.wait(40.0)
    assert [len(_payloads(path, channel)) for channel in "ABC"] == [3, 3, 0]


def test_a_pause_leaves_messages_out(bus_url, path, wait_until):
    plain = lcm.LCM(bus_url)
    with _recording(bus_url, path) as recorder:
        _publish(plain, "A", 1)
        wait_until(lambda: recorder.progress().messages == 1)
        recorder.is_paused = True
        _publish(plain, "B", 1)
        recorder.is_paused = False  # before B is read, as a rule
        _publish(plain, "C", 1)
        wait_until(lambda: recorder.progress().messages == 2)
    assert [len(_payloads(path, channel)) for channel in "ABC"] == [1, 0, 1]


_KILLED = """
import os, random, signal, sys, time
import lcm
from pathlib import Path
from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import Limits, BagRecorder, open_bus
from lcmtools.bag.series import LogSeries
from lcmtools.bus.url import parse_url
from lcmtools.observe.reading.find import GLOBAL
import lcmtools.packages.user_types

url = os.environ["LCM_DEFAULT_URL"]

def record(path):
    with open_bus(parse_url(url), os.environ) as monitor:
        limits = Limits(split_bytes=None)
        with BagRecorder(monitor, RecordedTopics((), GLOBAL), LogSeries(path), limits) as recorder:
            recorder.wait(1000.0)

for turn in range(2):
    children = {}
    for number in range(20):
        path = f"{turn}-{number}.lcmlog"
        if not (pid := os.fork()):
            record(path)
            os._exit(0)
        children[pid] = path
    while not all(Path(path + ".index").exists() for path in children.values()):
        if os.waitpid(-1, os.WNOHANG)[0]:
            sys.exit("a recorder ended by itself")
        time.sleep(0.01)
    bus, count = lcm.LCM(url), 0
    for pid in random.sample(list(children), 20):
        for _ in range(random.randrange(1, 10)):
            count += 1
            bus.publish("COUNT", count.to_bytes(8, "big") * random.choice([1, 100, 20_000]))
            time.sleep(random.random() * 0.01)
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
    del bus
print("all are dead", flush=True)
"""


def test_recorders_killed_at_any_instant_leave_readable_logs(bus_url, tmp_path, start_python):
    start_python(_KILLED, LCM_DEFAULT_URL=bus_url).wait_for("all are dead", timeout=100.0)
    logs = sorted(tmp_path.glob("*.lcmlog"))
    assert len(logs) == 40
    seen = 0
    for log in logs:
        with LogFile(log) as file:
            ends = [0, *(event.end for event in file.events())]
            assert [event.start for event in file.events()] == ends[:-1], log  # nothing is damaged
            counts = [packet.payload for packet in file.packets() if packet.channel == "COUNT"]
        assert all(payload == payload[:8] * (len(payload) // 8) for payload in counts)
        assert len({payload[:8] for payload in counts}) == len(counts)
        seen += len(counts)
    assert seen > 40


def test_a_full_disk_ends_it_with_one_line_and_a_readable_log(bus_url, path, start, lcmtools_path):
    command = ("bag", "record", "-o", str(path))
    program = start("prlimit", "--fsize=100000", lcmtools_path, *command, LCM_DEFAULT_URL=bus_url)
    plain = lcm.LCM(bus_url)
    sent = []
    while program._process.poll() is None:
        sent += _publish(plain, "EXAMPLE", 10, size=1000)
        if path.exists():
            os.sched_yield()
    assert program.wait() == 1
    (line,) = program.lines
    failure = f"lcmtools bag record: cannot write {path}: File too large"
    wanted = rf"{failure}; {path} has 9\d\.\d KB of complete messages"
    assert re.fullmatch(wanted, line), line
    kept = _payloads(path, "EXAMPLE")
    assert 80 < len(kept) <= 100
    assert path.stat().st_size == len(kept) * (28 + 7 + 1000)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_with_all_that_came(bus_url, path, cli, number):
    plain = lcm.LCM(bus_url)
    is_sent = False

    def has_sent(_):
        nonlocal is_sent
        if path.exists() and not is_sent:
            is_sent = True
            _publish(plain, "EXAMPLE", 20)
        return is_sent and path.stat().st_size > 0

    environment = {"LCM_DEFAULT_URL": bus_url}
    result = cli("bag", "record", "-o", str(path), env=environment, until=has_sent, ends_by=number)
    assert result.code == (130 if number == signal.SIGINT else 128 + number)
    (line,) = result.err.splitlines()
    size = f"{path.stat().st_size} B"
    assert_says(line, "lcmtools bag record: ", "20 messages", size, str(path), "no losses")
    assert len(_payloads(path, "EXAMPLE")) == 20


def test_a_signal_that_comes_as_it_begins_ends_it_too(bus_url, path, cli, monkeypatch):
    start = threading.Thread.start

    def start_and_interrupt(thread):
        start(thread)
        if thread.name == "recorder":
            signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(threading.Thread, "start", start_and_interrupt)
    result = cli("bag", "record", "-o", str(path), env={"LCM_DEFAULT_URL": bus_url})
    assert result.code == 128 + signal.SIGTERM
    (line,) = result.err.splitlines()
    assert_says(line, "lcmtools bag record: ", "0 messages", "0 B", str(path), "no losses")
    assert not [one for one in threading.enumerate() if one.name == "recorder"]


def test_services_pause_and_go_on(bus_url, path, start, lcmtools_path, cli, wait_until):
    words = ("-o", str(path), "--paused", "--services", "/recorder", "-n", "1", "EXAMPLE")
    program = start(lcmtools_path, "bag", "record", *words, LCM_DEFAULT_URL=bus_url)
    environment = {"LCM_DEFAULT_URL": bus_url}
    wait_until(lambda: "start" in cli("service", "list", env=environment).out)
    _publish(lcm.LCM(bus_url), "EXAMPLE", 1)
    called = cli("service", "call", "/recorder/start", env=environment, input="")
    assert "success: True" in called.ok()
    _publish(lcm.LCM(bus_url), "EXAMPLE", 1)
    assert program.wait() == 0
    assert len(_payloads(path, "EXAMPLE")) == 1


def _recorder(start, lcmtools_path, url, *words):
    return start(lcmtools_path, "bag", "record", *words, LCM_DEFAULT_URL=url)


def test_a_short_recording_names_what_was_silent_too(bus_url, path, cli, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    made = cli("bag", "record", "/silent", "--duration", "0.1s", "-o", str(path))
    line = made.err.splitlines()[0]
    assert_says(line, "lcmtools bag record: ", "no message", "/silent", "lcmtools list")


def test_what_was_recorded_is_reported_as_json(bus_url, path, start, lcmtools_path, wait_until):
    words = ("-o", str(path), "-n", "5", "EXAMPLE", "--json")
    program = _recorder(start, lcmtools_path, bus_url, *words)
    wait_until(path.exists)  # it has joined the bus before
    _publish(lcm.LCM(bus_url), "EXAMPLE", 5)
    assert program.wait() == 0
    assert json.loads(program.output) == {
        "files": [str(path)],
        "messages": 5,
        "bytes": path.stat().st_size,
        "losses": [],
        "buffer_overflows": 0,
    }


def test_tcpq_is_recorded(tcpq_server, path, start, lcmtools_path, wait_until):
    words = ("-o", str(path), "-n", "20", "EXAMPLE")
    program = _recorder(start, lcmtools_path, tcpq_server.url, *words)
    wait_until(lambda: tcpq_server.patterns)
    sent = _publish(lcm.LCM(tcpq_server.url), "EXAMPLE", 20)
    assert program.wait() == 0, program.output
    assert _payloads(path, "EXAMPLE") == sent
    assert "20 messages" in program.output
    assert "losses are not known on this bus" in program.output  # tcpq numbers no messages


def test_a_condition_saves_a_snapshot_of_what_came_before_and_after(
    bus_url, path, start, lcmtools_path, wait_until
):
    words = ("--snapshot", "1m", "--after", "100ms", "--when", "/estop m.data", "-o", str(path))
    program = _recorder(start, lcmtools_path, bus_url, *words)
    bus, stop = lcm.LCM(bus_url), Bool()
    wait_until(lambda: "/_lcmtools_record" in _tools(bus_url))
    before = _publish(bus, "EXAMPLE", 5)
    bus.publish("/estop", encode(stop))
    _publish(bus, "EXAMPLE", 5)
    assert not path.exists()
    stop.data = True
    bus.publish("/estop", encode(stop))
    wait_until(lambda: index_path(path).exists() and '"end"' in index_path(path).read_text())
    program.send_signal(signal.SIGINT)
    program.wait()
    assert _payloads(path, "EXAMPLE") == before * 2
    assert len(_payloads(path, "/estop")) == 2
    assert "12 messages" in program.output


def _tools(url):
    with BusMonitor(parse_url(url), "test", os.environ) as monitor:
        return str([node.name for node in monitor.discover().nodes])


def test_keys_pause_save_and_end(bus_url, path, lcmtools_path, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    words = ("bag", "record", "--snapshot", "1m", "-o", str(path))
    with closing(Typist(lcmtools_path, *words)) as typist:
        typist.wait_for("keeping 0 messages")
        bus = lcm.LCM(bus_url)
        _publish(bus, "A", 3)
        typist.wait_for("keeping 3 messages")
        typist.type(" ")
        typist.wait_for("paused (space resumes)")
        _publish(bus, "B", 3)
        typist.type(" ")
        typist.wait_for("none lost")
        typist.type("s")
        typist.wait_for("; 3 messages, ")
        typist.type("q")
        assert typist.end() == 0
        assert typist.settings() == typist.before
    assert (len(_payloads(path, "A")), len(_payloads(path, "B"))) == (3, 0)


@pytest.mark.parametrize(("size", "least"), [(1000, 1_040_000), (200_000, 5 * 200_000)])
def test_a_disk_of_a_megabyte_is_filled_to_the_last_message_that_fits(
    bus_url, tmp_path, start, lcmtools_path, size, least
):
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    kept.mkdir()
    script = f"mount -t tmpfs -o size=1m tmpfs {disk} || exit 99; : > {tmp_path}/begun\n"
    script += f'"$@"; code=$?; cp {disk}/* {kept}; exit $code'
    words = (lcmtools_path, "bag", "record", "-o", str(disk / "ride.lcmlog"))
    program = start("unshare", "-rm", "sh", "-c", script, "sh", *words, LCM_DEFAULT_URL=bus_url)
    bus = lcm.LCM(bus_url)
    while program._process.poll() is None:
        _publish(bus, "EXAMPLE", 10, size=size)
    if program.wait() == 99 or "unshare" in program.output:
        pytest.skip("no file system may be mounted here")
    assert program.wait() == 1
    (line,) = program.lines
    assert "No space left on device; " in line
    path = kept / "ride.lcmlog"
    payloads = _payloads(path, "EXAMPLE")
    assert {len(payload) for payload in payloads} == {size}
    assert path.stat().st_size == len(payloads) * (28 + 7 + size) >= least
