"""Logs that are cut off or damaged: every whole event is read, whatever follows it.

The events are laid out by hand from the format's description; what is expected follows from where
they end.
"""

from pathlib import Path

import pytest
from fixtures.wire import encode_event

import lcmtools.bag
from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.messages.codec import encode
from lcmtools.types.builtin_interfaces import Time
from lcmtools.types.geometry_msgs import PointStamped
from lcmtools.wire.log_events import HEAD_BYTES, SYNC, packets
from lcmtools.wire.packet import Packet

PAYLOADS = [encode(Time())[:8] + bytes([0, 0, 0, number] * 2) for number in range(3)]
EVENTS = [
    encode_event(number, Packet("/a", payload, (1_795_000_000 + number) * 1_000_000_000))
    for number, payload in enumerate(PAYLOADS)
]
WHOLE = b"".join(EVENTS)
EVENT = len(EVENTS[0])
EVERY_CUT = range(EVENT, len(WHOLE))
NEAR_AN_END = [
    n * EVENT + by for n in (1, 2) for by in (0, 1, 4, HEAD_BYTES, EVENT // 2, EVENT - 1)
]
"""Cuts for what takes long: a file's end on, after and before an event's, and in its parts."""


def whole_events(cut):
    return cut // EVENT


def by_python(_, path):
    with lcmtools.bag.open(path) as log:
        return len(list(log))


def by_info(cli, path):
    out = cli("bag", "info", str(path)).ok()
    assert ("damaged: " in out) == (path.stat().st_size % EVENT > 0)
    return int(out.split(" in ")[1].split()[0])


def by_fix(cli, path):
    result = cli("bag", "fix", str(path), f"{path}.fixed", "--force")
    assert result.code == (1 if path.stat().st_size % EVENT else 0)
    return len(list(packets(Path(f"{path}.fixed").read_bytes())))


def by_play(_, path):
    said = list[str]()
    with Playlist([path], Choice(), said.append) as playlist:
        assert len(said) == (path.stat().st_size % EVENT > 0)
        return len(list(playlist.messages(*playlist.span)))


def by_echo(cli, path):
    result = cli("echo", "-b", str(path), "/a")
    assert ("do not belong" in result.err) == (path.stat().st_size % EVENT > 0)
    return result.out.count("---")


def by_export(cli, path):
    result = cli("bag", "export", str(path), f"{path}.jsonl", "--force")
    assert result.code == (1 if path.stat().st_size % EVENT else 0)
    return Path(f"{path}.jsonl").read_text().count("\n")


@pytest.mark.parametrize(
    ("read", "cuts"),
    [
        (by_python, EVERY_CUT),
        *((read, NEAR_AN_END) for read in (by_info, by_fix, by_play, by_echo, by_export)),
    ],
)
def test_a_log_cut_off_at_any_byte_has_its_whole_events(read, cuts, cli, tmp_path):
    path = tmp_path / "cut.lcmlog"
    for cut in cuts:
        path.write_bytes(WHOLE[:cut])
        assert read(cli, path) == whole_events(cut), cut


@pytest.mark.parametrize("change", [0x01, 0x10, 0xFF])
def test_a_damaged_byte_costs_its_own_event_at_most(change):
    for at in range(len(WHOLE)):
        damaged = bytearray(WHOLE)
        damaged[at] ^= change
        found = [packet.payload for packet in packets(bytes(damaged))]
        others = [one for number, one in enumerate(PAYLOADS) if number != at // EVENT]
        assert [one for one in found if one in others] == others, at
        assert len(found) <= len(PAYLOADS), at


@pytest.mark.parametrize(
    "between", [b"\0", SYNC[:3], b"\0" * 4096, SYNC, SYNC + b"\0" * 24, SYNC + b"\xff" * 60]
)
def test_what_stands_between_events_costs_none(between):
    found = list(packets(EVENTS[0] + between + EVENTS[1] + between))
    assert [one.payload for one in found] == PAYLOADS[:2]


def test_a_log_in_a_payload_stays_one_message():
    inner = encode_event(0, Packet("/log", WHOLE[: EVENT + HEAD_BYTES + 5], 0))
    found = list(packets(inner + b"\0" + EVENTS[1]))
    assert [one.payload for one in found] == [WHOLE[: EVENT + HEAD_BYTES + 5], PAYLOADS[1]]


@pytest.mark.parametrize("lost", [0, 5])
@pytest.mark.parametrize(
    "command",
    [
        "echo -b {log} /a",
        "hz -b {log} /a",
        "bw -b {log} /a",
        "delay -b {log} /stamped",
        "plot -b {log} /a/sec -o {log}.png",
        "bag plot {log} /a/sec",
        "bag sort {log} {log}.made",
        "bag merge {log} {log} -o {log}.made",
        "bag cut {log} {log}.made",
        "bag diff {log} {log}",
        "bag du {log}",
        "bag check {log} --against {log}.contract",
    ],
)
def test_a_command_that_reads_a_whole_log_tells_of_damage(cli, tmp_path, command, lost):
    path = tmp_path / "a.lcmlog"
    stamped = encode_event(3, Packet("/stamped", encode(PointStamped()), 1_795_000_003 * 10**9))
    path.write_bytes(stamped + WHOLE[: len(WHOLE) - lost])
    (tmp_path / "a.lcmlog.contract").write_text("topics: {/stamped: {}}")
    result = cli(*command.format(log=path).split())
    assert result.code == 0
    assert ("do not belong to any message; lcmtools bag fix" in result.err) == bool(lost)
