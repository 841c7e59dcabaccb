"""The filter before liblcm's socket, run here by a small machine of the test's own."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus.shield import filter_program
from lcmtools.bus.socket_filter import Instruction
from lcmtools.wire.datagram import Fragment, Malformed, fragments, parse, short_message

PROGRAM = filter_program()
UDP_HEADER = bytes(8)


def accepts(datagram: bytes) -> bool:  # noqa: C901 - an operation a branch
    """What the kernel would answer (linux/filter.h, bpf(2) of BSD)."""
    packet = UDP_HEADER + datagram
    accumulator = index = position = 0
    for _ in range(len(PROGRAM) + 1):
        step: Instruction = PROGRAM[position]
        position += 1
        size = {0x20: 4, 0x28: 2, 0x30: 1}.get(step.code)
        if size:
            if step.k + size > len(packet):
                return False
            accumulator = int.from_bytes(packet[step.k : step.k + size], "big")
        elif step.code == 0x80:
            accumulator = len(packet)
        elif step.code == 0x01:
            index = step.k
        elif step.code == 0x07:
            index = accumulator
        elif step.code in (0x0C, 0x14, 0x1C):
            amount = step.k if step.code == 0x14 else index
            accumulator += amount if step.code == 0x0C else -amount
            accumulator &= 0xFFFFFFFF
        elif step.code == 0x05:
            position += step.k
        elif step.code == 0x06:
            return step.k != 0
        else:
            holds = {
                0x15: accumulator == step.k,
                0x25: accumulator > step.k,
                0x3D: accumulator >= index,
            }[step.code]
            position += step.if_true if holds else step.if_false
    raise AssertionError("the program does not end")


def expected(datagram: bytes) -> bool:
    """What the project's own parser thinks, which an empty channel does not bother."""
    parsed = parse(datagram)
    if isinstance(parsed, Malformed):
        return False
    return parsed.channel != ""


def test_the_kernel_takes_programs_of_this_size() -> None:
    assert len(PROGRAM) < 4096
    assert all(0 <= step.if_true < 256 and 0 <= step.if_false < 256 for step in PROGRAM)


@pytest.mark.parametrize("size", [1, 2, 62, 63])
def test_names_of_all_lengths_pass(size: int) -> None:
    assert accepts(short_message(7, "c" * size, b""))
    assert accepts(short_message(7, "c" * size, b"payload"))


@pytest.mark.parametrize("size", [65_500, 100_000, 300_000])
def test_every_fragment_of_a_large_message_passes(size: int) -> None:
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
def test_what_is_malformed_is_dropped(datagram: bytes) -> None:
    assert not accepts(datagram)


@given(st.binary(max_size=120), st.sampled_from([b"LC02", b"LC03", b""]))
def test_it_agrees_with_the_parser_on_any_bytes(rest: bytes, magic: bytes) -> None:
    assert accepts(magic + rest) == expected(magic + rest)


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.integers(0, 3), st.integers(0, 3))
def test_it_agrees_with_the_parser_on_any_fragment(
    size: int, offset: int, number: int, count: int
) -> None:
    for small in (size, size % 200):
        header = b"LC03\0\0\0\1" + small.to_bytes(4, "big") + (offset % 300).to_bytes(4, "big")
        datagram = (
            header + number.to_bytes(2, "big") + count.to_bytes(2, "big") + b"name\0" + bytes(90)
        )
        assert accepts(datagram) == expected(datagram)


def test_it_agrees_with_the_parser_on_mutations_of_real_datagrams() -> None:
    chance = random.Random(1)  # noqa: S311 - to choose bytes
    real = [short_message(3, "/chatter", bytes(20)), *fragments(4, "/big", bytes(70_000))]
    assert isinstance(parse(real[-1]), Fragment)
    for _ in range(3000):
        datagram = bytearray(chance.choice(real)[: chance.choice((8, 24, 40, 70_000))])
        datagram[chance.randrange(len(datagram))] = chance.randrange(256)
        assert accepts(bytes(datagram)) == expected(bytes(datagram))
