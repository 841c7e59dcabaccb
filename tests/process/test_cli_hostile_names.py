"""Names of a stranger's types, hosts and values neither steer the terminal nor begin a line."""

import json
import os
import socket
import sys

import pytest
from fixtures.wire import encode_event

from lcmtools.bus.records import NodeRecords
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.cli.main import main
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    decode_probe,
    encode_announcement,
)
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet

_EVIL = "\x1b[2J\r\n\x07\x9b31m\u202eevil"
_STEERING = ("\x1b", "\r", "\x07", "\x9b", "\u202e")
_ENDPOINTS = (
    Endpoint("/t", Role.PUBLISHER, (f"pkg/{_EVIL}",), (1,)),
    Endpoint("/s", Role.SERVICE, (f"pkg/{_EVIL}",), (2,)),
)


@pytest.fixture
def stranger(bus_url, cli):
    """A node that has such names; run commands beside it."""
    bus = UdpBus(parse_url(bus_url))
    node = NodeInfo("/stranger", "id", _EVIL, os.getpid(), command=_EVIL, endpoints=_ENDPOINTS)

    def answer(payload, _time):
        probe = decode_probe(payload)
        assert probe is not None
        bus.publish(NODE_CHANNEL, encode_announcement(Announcement(node, answers=probe.nonce)))

    bus.subscribe(PROBE_CHANNEL, answer)
    records = NodeRecords(parse_url(bus_url), os.environ)
    # who looks waits for it, however busy this process is
    records.write(node._replace(host=socket.gethostname()))

    yield lambda *words: cli(*words, "--lcm-url", bus_url).ok()
    records.remove(node.id)
    bus.close()


@pytest.mark.parametrize(
    "words",
    [
        ["type", "/t"],
        ["list", "-v"],
        ["info", "/t"],
        ["node", "list", "-a"],
        ["node", "info", "/stranger"],
        ["node", "ping", "/stranger", "-c", "1"],
        ["service", "type", "/s"],
        ["list", "--json"],
        ["node", "list", "--json"],
    ],
    ids=" ".join,
)
def test_a_strangers_names_are_shown_escaped(stranger, words):
    output = stranger(*words)
    assert not [one for one in _STEERING if one in output]
    assert "evil" in output or words[1] == "ping"
    if "--json" in words:
        assert any(str(one).endswith(_EVIL) for one in json.loads(output)[0].values())


def test_on_a_terminal_csv_has_no_control_characters(tmp_path, monkeypatch, capsys):
    path = tmp_path / "a.log"
    message = String()
    message.data = _EVIL
    path.write_bytes(encode_event(0, Packet(_EVIL, encode(message), 0)) * 2)
    words = ["echo", "-b", str(path), "**", "--csv"]
    assert main(words) == 0
    assert capsys.readouterr().out.count("\x1b") == 4  # nothing is lost in a file
    assert main([*words, "--field", "none"]) == 0
    assert len(capsys.readouterr().err.splitlines()) == 1
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert main(words) == 0
    output = capsys.readouterr().out
    assert output.count("evil") == 4
    assert not [one for one in _STEERING if one in output]
