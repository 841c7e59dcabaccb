"""Fixtures of the tests of filters: the kernel's machine for them."""

import pytest


@pytest.fixture(scope="session")
def lets_pass():
    """``lets_pass(program, datagram, port=0)``: what the kernel would answer."""
    return _run


def _run(program, datagram, port=0):  # noqa: C901 - an operation a branch
    """The machine of linux/filter.h, which is that of BSD's bpf(4)."""
    packet = port.to_bytes(2, "big") + bytes(6) + datagram  # behind the UDP header
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
        elif step.code == 0x54:
            accumulator &= step.k
        elif step.code == 0x05:
            position += step.k
        elif step.code == 0x06:
            return step.k != 0
        else:
            assert step.code == 0x15
            holds = accumulator == step.k
            position += step.if_true if holds else step.if_false
    raise AssertionError("the program does not end")
