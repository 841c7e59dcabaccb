"""Programs of socket filters, which the Linux kernel runs (classic BPF); see ``kernel.attach``.

A filter sees each datagram, with its UDP header, before it is queued. It returns the number of
bytes to keep, UDP header included. 0 drops the datagram; so does a load from beyond its end.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from lcmtools.wire.datagram import (
    CHANNEL_MAX,
    FRAGMENT_HEADER_BYTES,
    MAGIC_FRAGMENT,
    MAGIC_SHORT,
    SHORT_HEADER_BYTES,
)

# Operations (linux/bpf_common.h): A is the accumulator, X the index register.
_LOAD_WORD, _LOAD_HALF, _LOAD_BYTE, _LOAD_LENGTH = 0x20, 0x28, 0x30, 0x80
_LOAD_WORD_AT_X = 0x40
_LOAD_X, _AND, _RETURN = 0x01, 0x54, 0x06
_JUMP, _JUMP_EQUAL, _JUMP_GREATER, _JUMP_GREATER_EQUAL = 0x05, 0x15, 0x25, 0x35

_UDP_HEADER = 8  # bytes that a UDP socket's filter sees before the datagram
_SOURCE_PORT = 0  # offset in it
_PACKET_TYPE, _FROM_NETWORK = 0xFFFFF004, 2
"""SKF_AD_PKTTYPE (linux/filter.h), and PACKET_MULTICAST (linux/if_packet.h): not looped back."""
_SHORT, _FRAGMENT = (int.from_bytes(magic, "big") for magic in (MAGIC_SHORT, MAGIC_FRAGMENT))
_SEQNO = _UDP_HEADER + 4
_CHANNEL = _UDP_HEADER + SHORT_HEADER_BYTES  # offset of the channel in a short message
_SIZE, _NUMBER = _UDP_HEADER + 8, _UDP_HEADER + 16  # in a fragment
_PAYLOAD = _UDP_HEADER + FRAGMENT_HEADER_BYTES  # in the first fragment, where the channel begins
_HEAD_BYTES = _PAYLOAD + CHANNEL_MAX + 1 + 8  # up to the fingerprint after the longest channel
ENDING_BYTES = 4  # length of the endings in ``these_endings``
_LOADS = {4: _LOAD_WORD, 2: _LOAD_HALF, 1: _LOAD_BYTE}


class Instruction(NamedTuple):
    """One instruction; jumps are relative to the next one."""

    code: int
    k: int = 0
    if_true: int = 0
    if_false: int = 0


FilterProgram = Sequence[Instruction]
ChannelTest = Callable[[int], FilterProgram]
"""Returns a program that accepts the datagrams on some channels, whose names begin at an offset."""
_ACCEPT, _DROP = Instruction(_RETURN, 0xFFFFFFFF), Instruction(_RETURN, 0)


def everything(_start: int) -> FilterProgram:
    """Accept every channel; a ``ChannelTest``."""
    return [_ACCEPT]


def these_channels(channels: Iterable[str]) -> ChannelTest:
    """Return the test for these channels."""
    names = (channel.encode() + b"\0" for channel in channels)
    # shorter names first, so that no datagram ends before the bytes it is compared with
    ordered = sorted(names, key=len)
    return lambda start: [*(step for name in ordered for step in _accept_name(name, start)), _DROP]


def these_endings(endings: Collection[bytes]) -> ChannelTest:
    """Return the test for channels with these endings of four bytes each."""
    tests = [
        Instruction(_JUMP_EQUAL, int.from_bytes(ending, "big"), left, 0)
        for left, ending in zip(range(len(endings), 0, -1), endings, strict=True)
    ]

    def program(start: int) -> FilterProgram:
        ending = Instruction(_LOAD_WORD_AT_X, start - ENDING_BYTES - 1)
        return [*_find_channel_end(start), ending, *tests, _DROP, _ACCEPT]

    return program


def wanted(
    test: ChannelTest,
    unwanted: Iterable[tuple[int, int]] = (),
    *,
    shorts: bool = True,
    share: tuple[int, int] | None = (0, 1),
    heads: bool = False,
) -> FilterProgram:
    """Accept short messages and first fragments that pass a test, and other fragments.

    Args:
        test: The test of their channels.
        unwanted: Source port and size of large messages whose other fragments are dropped.
        shorts: Accept short messages.
        share: The share of the fragments, and the number of shares; None for no fragments.
        heads: Of the fragments, accept the first ones only.
    """
    later = [_DROP] if heads else [*_deny(unwanted), _ACCEPT]
    fragment = [_DROP] if share is None else [*_take_share(*share), *_by_number(test, later)]
    return [
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, _SHORT, 0, 1),
        Instruction(_JUMP, 2 + len(fragment)),
        Instruction(_JUMP_EQUAL, _FRAGMENT, 1, 0),
        _DROP,
        *fragment,
        *(test(_CHANNEL) if shorts else [_DROP]),
    ]


def heads_only(but_up_to: int = 0) -> FilterProgram:
    """Drop all fragments but the first; malformed datagrams pass.

    All fragments of messages up to ``but_up_to`` bytes pass.
    """
    return [
        Instruction(_LOAD_LENGTH),
        Instruction(_JUMP_GREATER_EQUAL, _PAYLOAD, 0, 7),
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, _FRAGMENT, 0, 5),
        Instruction(_LOAD_HALF, _NUMBER),
        Instruction(_JUMP_EQUAL, 0, 3, 0),
        Instruction(_LOAD_WORD, _SIZE),
        Instruction(_JUMP_GREATER, but_up_to, 0, 1),
        _DROP,
        _ACCEPT,
    ]


def large_only(up_to: int) -> FilterProgram:
    """Accept only fragments, of messages up to ``up_to`` bytes."""
    return [
        Instruction(_LOAD_LENGTH),
        Instruction(_JUMP_GREATER_EQUAL, _PAYLOAD, 0, 4),
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, _FRAGMENT, 0, 2),
        Instruction(_LOAD_WORD, _SIZE),
        Instruction(_JUMP_GREATER, up_to, 0, 1),
        _DROP,
        _ACCEPT,
    ]


def short_only(share: int = 0, shares: int = 1) -> FilterProgram:
    """Accept the short messages of one share (from 0): every ``shares``-th of each sender.

    Malformed datagrams belong to the first share. The number of shares is a power of two.
    """
    return [
        Instruction(_LOAD_LENGTH),
        Instruction(_JUMP_GREATER_EQUAL, _CHANNEL, 0, 8),
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, _SHORT, 3, 0),
        Instruction(_JUMP_EQUAL, _FRAGMENT, 0, 5),
        Instruction(_LOAD_LENGTH),
        Instruction(_JUMP_GREATER_EQUAL, _PAYLOAD, 4, 3),
        Instruction(_LOAD_WORD, _SEQNO),
        Instruction(_AND, shares - 1),
        Instruction(_JUMP_EQUAL, share, 2, 1),
        _DROP if share else _ACCEPT,
        _DROP,
        _ACCEPT,
    ]


def but_from(port: int, program: FilterProgram) -> FilterProgram:
    """Drop what this computer sends from a port; others' datagrams go on to a program."""
    return [
        Instruction(_LOAD_HALF, _SOURCE_PORT),
        Instruction(_JUMP_EQUAL, port, 0, 3),
        Instruction(_LOAD_WORD, _PACKET_TYPE),
        Instruction(_JUMP_EQUAL, _FROM_NETWORK, 1, 0),
        _DROP,
        *program,
    ]


def nothing() -> FilterProgram:
    """Drop everything."""
    return [_DROP]


def whole_on(prefix: str) -> FilterProgram:
    """Accept short messages whole if their channel begins so; of other messages only the head.

    Only the first four bytes of the prefix count.
    """
    start = int.from_bytes(prefix.encode()[:4].ljust(4, b"\0"), "big")
    return [
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, _SHORT, 0, 2),
        Instruction(_LOAD_WORD, _CHANNEL),
        Instruction(_JUMP_EQUAL, start, 5, 4),
        Instruction(_JUMP_EQUAL, _FRAGMENT, 0, 2),
        Instruction(_LOAD_HALF, _NUMBER),
        Instruction(_JUMP_EQUAL, 0, 1, 0),
        _DROP,
        Instruction(_RETURN, _HEAD_BYTES),
        _ACCEPT,
    ]


def _take_share(share: int, shares: int) -> FilterProgram:
    """Go on with every ``shares``-th fragment of a message."""
    if shares == 1:
        return []
    return [
        Instruction(_LOAD_HALF, _NUMBER),
        Instruction(_AND, shares - 1),
        Instruction(_JUMP_EQUAL, share, 1, 0),
        _DROP,
    ]


def _deny(unwanted: Iterable[tuple[int, int]]) -> Iterator[Instruction]:
    """Drop fragments of these source ports and sizes."""
    for port, size in unwanted:
        yield Instruction(_LOAD_HALF, _SOURCE_PORT)
        yield Instruction(_JUMP_EQUAL, port, 0, 3)
        yield Instruction(_LOAD_WORD, _SIZE)
        yield Instruction(_JUMP_EQUAL, size, 0, 1)
        yield _DROP


def _by_number(test: ChannelTest, later: FilterProgram) -> FilterProgram:
    """Accept first fragments that pass a test; others go on to ``later``."""
    return [
        Instruction(_LOAD_HALF, _NUMBER),
        Instruction(_JUMP_EQUAL, 0, 0, 1),
        Instruction(_JUMP, len(later)),
        *later,
        *test(_PAYLOAD),
    ]


def _accept_name(name: bytes, start: int) -> FilterProgram:
    """Accept a datagram with this name, its NUL included; other datagrams go on after it."""
    tests: list[Instruction] = [_ACCEPT]
    position = 0
    while position < len(name):  # the last bytes are compared first: the first ones are often equal
        size = next(size for size in _LOADS if size <= len(name) - position)
        expected = int.from_bytes(name[position : position + size], "big")
        tests.insert(0, Instruction(_JUMP_EQUAL, expected, 0, len(tests)))
        tests.insert(0, Instruction(_LOADS[size], start + position))
        position += size
    return tests


def _find_channel_end(start: int) -> Iterator[Instruction]:
    """Find the NUL after a name of 1 to 63 bytes; go on with X = the length of both."""
    yield Instruction(_LOAD_BYTE, start)
    yield Instruction(_JUMP_EQUAL, 0, 0, 1)
    yield _DROP
    for size in range(1, CHANNEL_MAX + 1):
        yield Instruction(_LOAD_BYTE, start + size)
        yield Instruction(_JUMP_EQUAL, 0, 0, 2)
        yield Instruction(_LOAD_X, size + 1)
        yield Instruction(_JUMP, 4 * (CHANNEL_MAX - size) + 1)
    yield _DROP
