"""Fixtures of the tests of filters: the kernel's machine for them."""

from collections.abc import Callable, Sequence

import pytest

from lcmtools.bus.socket_filter import Instruction

LetsPass = Callable[[Sequence[Instruction], bytes], bool]


@pytest.fixture(scope="session")
def lets_pass() -> LetsPass:
    """``lets_pass(program, datagram)``: what the kernel would answer."""
    return _run


def _run(program: Sequence[Instruction], datagram: bytes) -> bool:  # noqa: C901 - an operation a branch
    """The machine of linux/filter.h, which is that of BSD's bpf(4)."""
    packet = bytes(8) + datagram  # behind the UDP header
    accumulator = index = position = 0
    for _ in range(len(program) + 1):
        step = program[position]
        position += 1
        size = {0x20: 4, 0x28: 2, 0x30: 1}.get(step.code)
        if size:
            if step.k + size > len(packet):
                return False
            accumulator = int.from_bytes(packet[step.k : step.k + size], "big")
        elif step.code == 0x40:
            start = index + step.k
            if start + 4 > len(packet):
                return False
            accumulator = int.from_bytes(packet[start : start + 4], "big")
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
