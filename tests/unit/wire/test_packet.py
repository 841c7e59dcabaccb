"""Packets and senders."""

import pytest

from lcmtools.wire.packet import Packet, Sender


@pytest.mark.parametrize(
    ("payload", "fingerprint"),
    [
        (b"", None),
        (b"1234567", None),
        (bytes.fromhex("ffffffffffffffff"), 0xFFFFFFFFFFFFFFFF),
        (bytes.fromhex("2e7c07d7cdf7e027") + b"rest", 0x2E7C07D7CDF7E027),
    ],
)
def test_a_fingerprint_is_the_first_eight_bytes_unsigned(payload, fingerprint):
    assert Packet("A", payload, 0).fingerprint == fingerprint


def test_a_sender_reads_as_address_and_port():
    assert str(Sender("127.0.0.1", 45_001)) == "127.0.0.1:45001"
