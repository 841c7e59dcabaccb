"""The complete graph of a bus; of a log, all that is in it."""

from collections.abc import Mapping
from typing import Protocol

from lcmtools.graph.model import Graph
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rates import RateWindow
from lcmtools.wire.packet import Packet

_WINDOW = 50_000


class PacketCounter(Protocol):
    """Something that counts messages as they come."""

    def hear(self, packet: Packet) -> None:
        """Take a message into account."""
        ...


class Rates:
    """The rates at which messages come, by channel."""

    def __init__(self) -> None:
        self._windows: dict[str, RateWindow] = {}

    def hear(self, packet: Packet) -> None:
        """Take a message into account."""
        self._windows.setdefault(packet.channel, RateWindow(_WINDOW)).add(packet.time)

    def by_channel(self) -> Mapping[str, float]:
        """Return the rate [Hz] on each channel that had two messages."""
        rates = {channel: window.take() for channel, window in self._windows.items()}
        return {channel: rate.mean for channel, rate in rates.items() if rate}


def settled(
    monitor: BusMonitor, wait: float | None = None, rates: PacketCounter | None = None
) -> Graph:
    """Return the graph of a bus once it is complete; a log is read to its end at once.

    Args:
        monitor: The bus.
        wait: How long to listen for programs that announce nothing [s]; None for as long as it
            takes to receive from those of this computer that publish once a second.
        rates: Counts the messages during ``wait``, or all of a log.

    Raises:
        BusError: A log cannot be read.
    """
    if monitor.is_live:
        graph = monitor.settle(foreign=wait is None)
        if wait is None:
            return graph
    for packet in monitor.packets(wait):
        if rates:
            rates.hear(packet)
    return monitor.graph()
