"""What is on a bus, complete: of a log, all that is in it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Graph
from lcmtools.observe.log_file import read_log
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rates import RateWindow
from lcmtools.wire.packet import Packet

_WINDOW = 50_000


class Hearer(Protocol):
    """What takes messages into account as they come."""

    def hear(self, packet: Packet) -> None:
        """Take a message into account."""
        ...


@dataclass(slots=True)
class Rates:
    """How often messages come on each channel, while it hears them."""

    _windows: dict[str, RateWindow] = field(default_factory=dict)

    def hear(self, packet: Packet) -> None:
        """Take a message into account."""
        self._windows.setdefault(packet.channel, RateWindow(_WINDOW)).extend([packet.time])

    def by_channel(self) -> Mapping[str, float]:
        """Messages per second [Hz] on the channels on which there were two."""
        rates = {channel: window.take() for channel, window in self._windows.items()}
        return {channel: rate.mean for channel, rate in rates.items() if rate}


def settled(monitor: BusMonitor, wait: float | None = None, rates: Hearer | None = None) -> Graph:
    """The graph of a bus once it is complete; a log is read to its end at once.

    Args:
        monitor: The bus.
        wait: How long to listen for programs that announce nothing [s]; None for as long as it
            takes to hear those of this computer that publish once a second.
        rates: What hears the messages during ``wait``, or all of a log.

    Raises:
        BusError: A log cannot be read.
    """
    heard = rates or Rates()
    if monitor.url.provider == "file":
        return _read(monitor, heard)
    graph = monitor.settle(foreign=wait is None)
    if wait is None:
        return graph
    for packet in monitor.packets(wait):
        heard.hear(packet)
    return monitor.graph()


def _read(monitor: BusMonitor, rates: Hearer) -> Graph:
    builder = GraphBuilder()
    last = 0
    for packet in read_log(monitor.url):
        builder.hear(packet)
        rates.hear(packet)
        last = packet.time
    return builder.snapshot(last)
