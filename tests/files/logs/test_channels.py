"""Channels whose names are not UTF-8, or have control characters: LCM takes any bytes but zero."""

import json
from pathlib import Path

import pytest
from fixtures.wire import encode_event

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, decode_announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.names import Pattern, is_hidden, spellings
from lcmtools.types.builtin_interfaces import Time
from lcmtools.wire.log_events import packets
from lcmtools.wire.packet import Packet

NAMES = [  # bytes in the log, and as commands show and take them
    (b"caf\xe9", r"caf\xe9"),
    ("café".encode(), "café"),
    ("café".encode(), r"caf\xc3\xa9"),
    (b"/a/\xff\xfe", r"/a/\xff\xfe"),
    (b"bin\x01\x7f", r"bin\x01\x7f"),
    (b"half\xc3", r"half\xc3"),
    (b"a\\xe9", r"a\xe9"),  # it has a backslash itself
]
OTHER = b"/other"


def text(name):
    return name.decode("utf-8", "surrogateescape")


@pytest.fixture(params=NAMES, ids=str)
def names(request):
    found = request.param
    return found


@pytest.fixture
def log(names, tmp_path):
    path = tmp_path / "odd.lcmlog"
    found = (
        Packet(text(name), encode(Time()), 1_795_000_000_000_000_000) for name in (OTHER, names[0])
    )
    path.write_bytes(b"".join(encode_event(number, one) for number, one in enumerate(found)))
    return str(path)


def channels(path):
    return [one.channel for one in packets(Path(path).read_bytes())]


def test_a_name_is_found_by_its_spelling(names):
    name, spelling = names
    assert text(name) in spellings(spelling)
    assert Pattern(spelling).matches(text(name))
    assert Pattern(f"{spelling}*").matches(text(name))
    assert not Pattern(spelling).matches(text(OTHER))


def test_commands_take_the_spelling(names, log, cli, tmp_path):
    name, spelling = names
    out = str(tmp_path / "out")
    assert cli("echo", "-b", log, spelling).ok().count("---") == 1
    cli("bag", "filter", log, out, "-t", spelling).ok()
    assert channels(out) == [text(name)]
    cli("bag", "filter", log, out, "-x", spelling, "--force").ok()
    assert channels(out) == [text(OTHER)]
    cli("bag", "export", log, f"{out}.csv", "-t", spelling).ok()
    assert Path(f"{out}.csv").read_text().count("\n") == 2
    if "\\" not in text(name):
        cli("bag", "rename", log, out, f"{spelling}:=/new", "--force").ok()
        assert channels(out) == [text(OTHER), "/new"]


def test_they_are_played_as_they_are(names, log, cli, bus_url):
    with Tap(parse_url(bus_url), whole=True) as tap:
        cli("bag", "play", log, env={"LCM_DEFAULT_URL": bus_url})
        found = list[Packet]()
        while batch := tap.receive(0.5):
            found += [one for one in batch if not is_hidden(one.channel)]
    assert sorted(one.channel for one in found) == sorted(map(text, (OTHER, names[0])))
    assert {one.payload for one in found} == {encode(Time())}


def test_a_bus_without_such_channels_leaves_them_out_by_name(names, log, cli):
    result = cli("bag", "play", log, env={"LCM_DEFAULT_URL": "memq://"})
    try:
        names[0].decode()
    except UnicodeDecodeError:
        assert f"{names[1]} is left out" in result.err
        assert "1 message in" in result.err
    else:
        assert "2 messages in" in result.err
    assert result.code == 0


def test_a_summary_shows_the_spelling(names, log, cli):
    rows = cli("bag", "info", log).ok().splitlines()
    shown = r"a\xe9" if names[0] == b"a\\xe9" else text(names[0])
    (record,) = json.loads(cli("bag", "info", log, "--json").ok())
    assert shown in [one["topic"] for one in record["topics"]]
    assert len({row.index("builtin") for row in rows if "builtin" in row}) == 1


def test_a_node_announces_the_name_as_it_is(names):
    end = Endpoint(text(names[0]), Role.PUBLISHER, ("std_msgs/String",))
    announced = encode_announcement(Announcement(NodeInfo("/n", "1", "h", 1, endpoints=(end,))))
    read = decode_announcement(announced)
    assert read is not None
    assert [one.topic for one in read.node.endpoints] == [text(names[0])]
