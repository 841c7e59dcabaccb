"""The filter before liblcm's socket, run here by a small machine of the tests' own."""

import random
import socket
from collections.abc import Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus import channel_filter
from lcmtools.bus.channel_filter import ChannelFilter
from lcmtools.bus.socket_filter import Instruction, these_channels, these_endings, well_formed
from lcmtools.wire.datagram import Fragment, MalformedDatagram, fragments, parse, short_message

PROGRAM = well_formed()
Accepts = Callable[[bytes], bool]


@pytest.fixture(scope="session")
def accepts(lets_pass: Callable[[list[Instruction], bytes], bool]) -> Accepts:
    """``accepts(datagram)``: whether the filter lets it pass."""
    return lambda datagram: lets_pass(PROGRAM, datagram)


def expected(datagram: bytes) -> bool:
    """The judgement of the project's own parser, which takes an empty channel."""
    parsed = parse(datagram)
    if isinstance(parsed, MalformedDatagram):
        return False
    return parsed.channel != ""


def test_the_kernel_takes_programs_of_this_size() -> None:
    assert len(PROGRAM) < 4096
    assert all(0 <= step.if_true < 256 and 0 <= step.if_false < 256 for step in PROGRAM)


@pytest.mark.parametrize("size", [1, 2, 62, 63])
def test_names_of_all_lengths_pass(accepts: Accepts, size: int) -> None:
    assert accepts(short_message(7, "c" * size, b""))
    assert accepts(short_message(7, "c" * size, b"payload"))


@pytest.mark.parametrize("size", [65_500, 100_000, 300_000])
def test_every_fragment_of_a_large_message_passes(accepts: Accepts, size: int) -> None:
    assert all(accepts(part) for part in fragments(1, "/camera/image", bytes(size)))


@pytest.mark.parametrize(
    "datagram",
    [
        b"",
        b"LC0",
        b"LC02",
        b"LC02\0\0\0\1",
        b"LC02\0\0\0\1abc",
        b"LC02\0\0\0\1\0payload",
        b"LC02\0\0\0\1" + b"c" * 64 + b"\0",
        b"LC04\0\0\0\1abc\0",
        b"LC03" + bytes(15),
        b"LC03" + bytes(16),  # fragment 0 of 0
    ],
)
def test_what_is_malformed_is_dropped(accepts: Accepts, datagram: bytes) -> None:
    assert not accepts(datagram)


@given(st.binary(max_size=120), st.sampled_from([b"LC02", b"LC03", b""]))
def test_it_agrees_with_the_parser_on_any_bytes(
    accepts: Accepts, rest: bytes, magic: bytes
) -> None:
    assert accepts(magic + rest) == expected(magic + rest)


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.integers(0, 3), st.integers(0, 3))
def test_it_agrees_with_the_parser_on_any_fragment(
    accepts: Accepts, size: int, offset: int, number: int, count: int
) -> None:
    for small in (size, size % 200):
        header = b"LC03\0\0\0\1" + small.to_bytes(4, "big") + (offset % 300).to_bytes(4, "big")
        datagram = (
            header + number.to_bytes(2, "big") + count.to_bytes(2, "big") + b"name\0" + bytes(90)
        )
        assert accepts(datagram) == expected(datagram)


def test_it_agrees_with_the_parser_on_mutations_of_real_datagrams(accepts: Accepts) -> None:
    chance = random.Random(1)  # noqa: S311 - to choose bytes
    real = [short_message(3, "/chatter", bytes(20)), *fragments(4, "/big", bytes(70_000))]
    assert isinstance(parse(real[-1]), Fragment)
    for _ in range(3000):
        datagram = bytearray(chance.choice(real)[: chance.choice((8, 24, 40, 70_000))])
        datagram[chance.randrange(len(datagram))] = chance.randrange(256)
        assert accepts(bytes(datagram)) == expected(bytes(datagram))


@given(
    st.sets(st.text("ab", min_size=1, max_size=11), min_size=1, max_size=8),
    st.text("ab", min_size=1, max_size=11),
    st.binary(max_size=3),
)
def test_of_short_messages_only_those_on_the_channels_pass(
    lets_pass: Callable[[Sequence[Instruction], bytes], bool],
    channels: set[str],
    channel: str,
    payload: bytes,
) -> None:
    program = these_channels(channels)
    assert lets_pass(program, short_message(7, channel, payload)) == (channel in channels)
    assert all(0 <= step.if_true < 256 and 0 <= step.if_false < 256 for step in program)


@given(
    st.sets(st.text("ab", min_size=4, max_size=4), min_size=1, max_size=8),
    st.text("ab", min_size=4, max_size=63),
    st.binary(max_size=3),
)
def test_of_short_messages_only_those_on_channels_with_the_endings_pass(
    lets_pass: Callable[[Sequence[Instruction], bytes], bool],
    endings: set[str],
    channel: str,
    payload: bytes,
) -> None:
    program = these_endings([ending.encode() for ending in endings])
    assert lets_pass(program, short_message(7, channel, payload)) == (channel[-4:] in endings)


def test_large_messages_pass_on_all_channels(
    lets_pass: Callable[[Sequence[Instruction], bytes], bool],
) -> None:
    program = these_channels(["/other"])
    assert all(lets_pass(program, part) for part in fragments(1, "/camera/image", bytes(300_000)))
    assert not lets_pass(program, b"LC03" + bytes(15))
    assert not lets_pass(program, b"LC04\0\0\0\1/other\0")


def test_a_fleets_next_robot_passes_a_filter_of_endings_already(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(channel_filter, "attach", lambda *_: True)  # as on Linux
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        passing = ChannelFilter([receiver])
        passing.let_pass([f"/husky{number}/odometry" for number in range(50)])
        of_few = passing.passes("/husky50/odometry")
        passing.let_pass([f"/husky{number}/odometry" for number in range(51)])

        assert (of_few, passing.passes("/husky51/odometry")) == (False, True)
        assert not passing.passes("/husky51/imu")
