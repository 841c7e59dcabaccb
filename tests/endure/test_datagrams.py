"""Programs endure whatever strangers send to a bus: mutated datagrams, without end.

Each test takes some seconds; ENDURE_SECONDS=600 makes it take ten minutes. The datagrams of a seed
are the same each time; ENDURE_SEED chooses another one.
"""

import itertools
import os
import random
import re
import signal
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path

import pytest

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.graph.builder import MOST_FLOWS, MOST_NODES, GraphBuilder
from lcmtools.graph.model import CallbackError, Endpoint, NodeInfo, RelayStep, Role
from lcmtools.graph.protocol import (
    ANSWER_SPREAD,
    NODE_CHANNEL,
    PROBE_CHANNEL,
    RELAY_CHANNEL,
    SHUTDOWN_CHANNEL,
    Announcement,
    Probe,
    Shutdown,
    decode_announcement,
    encode_announcement,
    encode_probe,
    encode_shutdown,
    head_of,
)
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.lcmtools_msgs import RelayReport
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.rosgraph_msgs import Log as LogMessage
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import String
from lcmtools.wire.datagram import datagrams
from lcmtools.wire.packet import Sender
from lcmtools.wire.reader import Reader

Datagrams = Iterator[bytes]

SECONDS = float(os.environ.get("ENDURE_SECONDS", "8"))
SEED = int(os.environ.get("ENDURE_SEED", "1"))
GROUP = ("239.255.76.67", 7667)
RATE = 3000  # datagrams per second
PORTS = 200  # that they are sent from
MOST_MEMORY = 25_000_000  # bytes that a program may need more than before
TEXTS = ("hello", "\x1b[2J\x1b]0;title\x07", "a\nb\r\t\0", "größer \u202e", "x" * 3000)


def _text(chance):
    return chance.choice((*TEXTS, f"name_{chance.randrange(100_000)}"))


def _announcement(chance):
    number = chance.randrange(100_000)
    ends = tuple(
        Endpoint(f"/t{chance.randrange(1000)}", chance.choice(list(Role)), (_text(chance)[:50],))
        for _ in range(chance.choice((0, 1, 3, 100)))
    )
    errors = (CallbackError(_text(chance), "E", _text(chance), "a.py:1", 1, 1),)
    path = (RelayStep("r", "/r", _text(chance)),) if chance.random() < 0.1 else ()
    node = NodeInfo(f"/stranger_{number}", f"id{number}", _text(chance), number, path=path)
    node = node._replace(endpoints=ends, errors=errors, command=_text(chance))
    return encode_announcement(Announcement(node, chance.random() < 0.1, chance.randrange(9)))


def _message(chance):
    """A channel, and a payload that belongs on it."""
    string, log, twist = String(), LogMessage(), Twist()
    string.data = log.msg = _text(chance).replace("\0", "")
    log.level, log.name = 8, _text(chance).replace("\0", "")
    twist.linear.x = chance.choice((1.0, float("nan"), 1e300))
    kinds = [
        ("/chatter", lambda: encode(string)),
        (f"/svc/reply_{chance.randrange(100_000)}", lambda: encode(string)),
        ("/rosout", lambda: encode(log)),
        ("/cmd_vel", lambda: encode(twist)),
        ("/scan", lambda: encode(LaserScan())),
        ("/clock", lambda: encode(Clock())),
        (NODE_CHANNEL, lambda: _announcement(chance)),
        (PROBE_CHANNEL, lambda: encode_probe(Probe(chance.choice(("", "/talker")), 7))),
        (SHUTDOWN_CHANNEL, lambda: encode_shutdown(Shutdown("nobody", 7, _text(chance)))),
        (RELAY_CHANNEL, lambda: encode(RelayReport())),
        (f"/junk{chance.randrange(50)}", lambda: chance.randbytes(chance.randrange(100))),
        (f"odd {_text(chance)[:40]}".replace("\0", ""), lambda: b""),
    ]
    channel, payload = chance.choice(kinds)
    return channel, payload()


def _mutated(data, chance):
    """The same with a few bytes changed, left out, repeated or put in."""
    changed = bytearray(data)
    for _ in range(chance.choice((0, 0, 1, 1, 3, 20))):
        place = chance.randrange(len(changed) + 1)
        kind = chance.randrange(5)
        if kind == 0 and place < len(changed):
            changed[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            changed[place : place + 4] = chance.choice((b"\x7f\xff\xff\xff", b"\xff" * 4, bytes(4)))
        elif kind == 2:
            del changed[place:]
        elif kind == 3:
            changed[place:place] = changed[: chance.randrange(200)]
        else:
            changed[place:place] = chance.randbytes(chance.randrange(9))
    return bytes(changed)


def strangers(seed):
    """Datagrams without end: payloads mutated, datagrams mutated, fragments lost and mixed."""
    chance = random.Random(seed)  # noqa: S311 - the same bytes each time
    while True:
        channel, payload = _message(chance)
        if chance.random() < 0.002:  # of incomplete ones, 64 MB are kept
            payload += bytes(70_000)
        if chance.random() < 0.5:
            payload = _mutated(payload, chance)
        seqno, fault = chance.choice((chance.randrange(1 << 32), 7)), chance.random()
        for datagram in datagrams(seqno, channel, payload):
            if fault > 0.5:
                yield datagram
            elif chance.random() < 0.8:
                yield _mutated(datagram, chance)


def test_nothing_that_reads_datagrams_fails_or_grows():
    readers = [Reader(whole=True), Reader(whole=False)]
    graphs = [GraphBuilder(), GraphBuilder()]
    source, deadline, time_ns = strangers(SEED), time.monotonic() + SECONDS, 0
    while time.monotonic() < deadline:
        for number, datagram in enumerate(islice(source, 1000)):
            time_ns += 1_000_000_000 // RATE
            sender = Sender("10.0.0.1", number % PORTS)
            for reader, graph in zip(readers, graphs, strict=True):
                for packet in graph.add_all(reader.read_all([(datagram, sender, time_ns, 1)])):
                    graph.add_head(head_of(packet.payload), packet)
        for graph in graphs:
            known = graph.snapshot(time_ns)
            assert len(known.traffic) <= MOST_FLOWS
            assert len(known.nodes) <= MOST_NODES
            for topic in known.topics():
                graph.types_of(topic.name)


@pytest.fixture
def attack():
    """``attack(seconds)``: sends what strangers send from many ports; returns their number."""
    senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(PORTS)]
    source = strangers(SEED)

    def send(seconds):
        start = time.monotonic()
        for count, datagram in enumerate(source):
            senders[count % PORTS].sendto(datagram[:65_000], GROUP)
            if (late := count / RATE - (time.monotonic() - start)) > 0.002:
                time.sleep(late)
            if time.monotonic() - start > seconds:
                return count
        return 0

    yield send
    for sender in senders:
        sender.close()


@pytest.mark.usefixtures("private_network")
def test_a_flood_of_probes_of_one_node_gets_few_answers(start, lcmtools_path):
    start(lcmtools_path, "run", "talker").wait_for("hello world")
    packets = []
    with ThreadPoolExecutor(1) as flood, Tap(parse_url("udpm://")) as tap:
        sent = flood.submit(_probe_for, "/talker", SECONDS / 2)
        ping = start(lcmtools_path, "node", "ping", "talker", "-c", "1")
        while not sent.done():
            packets += tap.receive(0.1)
    assert ping.wait() == 0
    heard = [decode_announcement(one.payload) for one in packets]
    answers = [one for one in heard if one and one.node.name == "/talker"]
    assert 1 < len(answers) < SECONDS / ANSWER_SPREAD
    assert len(answers) < sent.result() / 2


def _probe_for(target, seconds):
    """Probe a node as often as strangers send, with another number each time."""
    start = time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for nonce in itertools.count(1):
            payload = encode_probe(Probe(target, nonce))
            for datagram in datagrams(nonce, PROBE_CHANNEL, payload):
                sender.sendto(datagram, GROUP)
            if (late := nonce / RATE - (time.monotonic() - start)) > 0.002:
                time.sleep(late)
            if time.monotonic() - start > seconds:
                return nonce
    return 0


def _memory(pid):
    """Bytes of memory that a process uses."""
    text = Path(f"/proc/{pid}/statm").read_text(encoding="ascii")
    return int(text.split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.usefixtures("private_network")
def test_programs_go_on_and_do_not_grow(start, lcmtools_path, tmp_path, attack, cli):
    path = tmp_path / "ride.lcmlog"
    programs = {
        "talker": start(lcmtools_path, "run", "talker"),
        "listener": start(lcmtools_path, "run", "listener"),
        "echo": start(lcmtools_path, "echo", "/**"),
        "hz": start(lcmtools_path, "hz", "/chatter"),
        "record": start(lcmtools_path, "bag", "record", "-o", str(path)),
    }
    programs["listener"].wait_for("I heard")
    programs["echo"].wait_for("hello world")
    programs["hz"].wait_for("average rate")
    attack(2.0)  # lets each import and cache what it needs
    before = {name: _memory(program.pid) for name, program in programs.items()}
    assert attack(SECONDS) > 0
    grown = {name: _memory(one.pid) - before[name] for name, one in programs.items()}
    assert {name: size for name, size in grown.items() if size > MOST_MEMORY} == {}

    for words in (("info", "/chatter"), ("node", "ping", "talker", "-c", "1")):
        assert cli(*words, env={"LCM_DEFAULT_URL": ""}).code == 0, words
    for name in ("record", "hz", "echo", "listener", "talker"):
        programs[name].send_signal(signal.SIGINT)
    for name, program in programs.items():
        assert program.wait() in (0, 130), name
        assert "Traceback" not in program.output, name
        assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f]", program.output), name
    with LogFile(path) as log:
        recorded = {packet.channel for packet in log.packets()}
    assert "/chatter" in recorded
