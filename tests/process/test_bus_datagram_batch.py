"""Datagrams that are taken many at a time are those that come one by one."""

import socket
import sys
import time

import pytest

from lcmtools.bus.datagram_batch import DatagramBatch
from lcmtools.bus.kernel import request_arrival
from lcmtools.wire.packet import Sender

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a call of Linux")
_SIZES = [*range(100), 1000, 65_000, 0, 65_507]  # more than one call takes


def _receiver():
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
    receiver.bind(("127.0.0.1", 0))
    receiver.settimeout(0.0)
    return receiver


def test_data_senders_times_and_times_to_live_are_those_of_the_datagrams():
    with _receiver() as receiver, _receiver() as one, _receiver() as other:
        assert request_arrival(receiver)
        other.setsockopt(socket.IPPROTO_IP, socket.IP_TTL, 7)
        batch = DatagramBatch(receiver)
        assert list(batch.receive(256)) == []
        for _ in range(2):
            begin = time.time_ns()
            sent = []
            for number, size in enumerate(_SIZES):
                sender = other if number % 3 else one
                sent.append((bytes([number]) * size, Sender(*sender.getsockname()), number % 3))
                sender.sendto(sent[-1][0], receiver.getsockname())
            found = list(batch.receive(256))
            assert [one[:2] for one in found] == [one[:2] for one in sent]
            assert [one[3] for one in found] == [7 if which else 64 for _, _, which in sent]
            times = [one[2] for one in found]
            assert begin <= times[0] <= times[-1] <= time.time_ns()
            assert times == sorted(times)


def test_a_closed_socket_is_an_error():
    with _receiver() as receiver:
        batch = DatagramBatch(receiver)
    with pytest.raises(OSError, match="descriptor"):
        list(batch.receive(256))
