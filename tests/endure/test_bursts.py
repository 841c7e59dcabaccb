"""Bursts that are faster than any program reads: what a recorder loses, it counts."""

import json
import signal
import socket
import time
from itertools import islice
from types import MappingProxyType

import pytest
from fixtures.limits import cpu_limit

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import BagRecorder
from lcmtools.bag.series import LogSeries
from lcmtools.bus.url import BusUrl
from lcmtools.names import Resolver
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

_GROUP = ("239.255.76.67", 7667)
_COUNT = 100_000
DATAGRAMS = {
    "numbered": lambda number: b"LC02%b/a\0" % number.to_bytes(4, "big"),
    "without numbers": lambda _: b"LC02\0\0\0\7/a\0",
    "a name each": lambda number: b"LC02%b/a%d\0" % (number.to_bytes(4, "big"), number),
}


@pytest.mark.usefixtures("private_network")
@pytest.mark.parametrize("datagram", DATAGRAMS.values(), ids=DATAGRAMS)
def test_what_a_recorder_loses_in_a_burst_is_counted(
    datagram, start, lcmtools_path, wait_until, tmp_path
):
    path = tmp_path / "a.lcmlog"
    record = start(lcmtools_path, "bag", "record", "--json", "-o", str(path))
    wait_until(path.exists)
    content = [datagram(number) + bytes(100) for number in range(_COUNT)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for data in content:
            sender.sendto(data, _GROUP)
    record.send_signal(signal.SIGINT)
    assert record.wait() == 130
    done = json.loads(record.output[record.output.index("{") :])
    with LogFile(path) as log:
        recorded = sum(packet.channel.startswith("/a") for packet in log.packets())
    lost = _COUNT - recorded
    assert 0 < recorded == done["messages"]
    numbered = sum(one["lost"] for one in done["losses"])
    assert max(numbered, done["buffer_overflows"]) >= lost
    assert numbered <= lost


class Burst:
    """A bus with one message on each of many channels, some of which wait to be read."""

    port, numbered = 0, MappingProxyType[Sender, Sequence]({})
    is_live, is_log, is_awaiting, has_strangers = True, False, False, False

    def __init__(self):
        self.packets = (
            Packet(f"/a{number}", bytes(100), time.time_ns()) for number in range(_COUNT)
        )

    def receive(self, timeout):
        """Return some messages."""
        if not (some := list(islice(self.packets, 500))):
            time.sleep(timeout)
        return some

    def send(self, channel, payload):
        """There is no receiver."""

    def close(self):
        """Nothing is open."""


def test_a_recording_of_many_channels_ends_soon(tmp_path, wait_until):
    path = tmp_path / "a.lcmlog"
    monitor = BusMonitor(BusUrl("memq", ""), "record", {}, Burst(), whole=True)
    series = LogSeries(str(path))
    with BagRecorder(monitor, RecordedTopics([], Resolver()), series) as recorder:
        wait_until(lambda: recorder.progress().messages > _COUNT * 0.9, 60.0)
        with cpu_limit(2.0):
            recorder.stop()
    with LogFile(path) as log:
        channels = {packet.channel for packet in log.packets()}
    assert len(channels) == recorder.progress().messages > _COUNT * 0.9
