"""The traffic of channels: recent rates, jitter and bandwidth, and totals.

Packets are accumulated; times come in as arguments. Arrivals are summed up in slots of a
quarter of a second, so that reading a busy channel's rates costs no more than a slow one's.
"""

import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from lcmtools.bounded import BoundedDict
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:  # lcmtools list --help must not import the bus
    from lcmtools.graph.model import Graph
    from lcmtools.observe.reading.monitor import BusMonitor

SILENT_AFTER = 3_000_000_000
"""A channel without a message for this time is silent [ns]; for a slow one it is longer."""

_SLOT = 250_000_000  # [ns]
_MEASURED = 1.0  # [s] for measuring rates, unless another time is given
_FEWEST = 3  # intervals that are kept however old they are, for slow channels
_SILENT_PERIODS = 3  # periods without a message are silence, if longer than SILENT_AFTER


class Flow(NamedTuple):
    """The traffic of one channel."""

    messages: int = 0  # the number of messages, in all
    bytes: int = 0  # bytes of their payloads, in all
    last_time: int = 0  # arrival of the last one [ns since 1970]
    # Recent message rate: 1 / the mean interval [Hz]; 0 for a silent channel, None before two
    # messages.
    rate: float | None = None
    # The longest recent interval minus the shortest, as in lcm-spy [s]; None before two intervals,
    # and for a silent channel.
    jitter: float | None = None
    bandwidth: float | None = None  # recent bytes per second; 0 or None as for the rate


class _Slot:
    """The intervals between messages that ended in one quarter of a second."""

    __slots__ = ("bytes", "intervals", "longest", "number", "shortest", "waited")

    def __init__(self, number: int) -> None:
        self.number = number
        self.intervals = self.bytes = self.waited = self.shortest = self.longest = 0

    def add(self, interval: int, size: int) -> None:
        if interval < self.shortest or not self.intervals:
            self.shortest = interval
        if interval > self.longest:  # noqa: PLR1730 - max would take as long as all the rest
            self.longest = interval
        self.intervals += 1
        self.bytes += size
        self.waited += interval


class _Channel:
    """One channel while it is being counted."""

    __slots__ = ("bytes", "last_time", "messages", "slots")

    def __init__(self) -> None:
        self.messages = self.bytes = self.last_time = 0
        self.slots: list[_Slot] = []  # a few

    def add(self, time: int, size: int, number: int) -> None:
        """Count a message, and the interval before it in the slot of this number."""
        before, self.last_time = self.last_time, time
        self.bytes += size
        self.messages += 1
        if self.messages == 1:
            return
        slots = self.slots
        if slots and slots[-1].number == number:
            slot = slots[-1]
        else:
            slot = _Slot(number)
            slots.append(slot)
        slot.add(time - before if time > before else 0, size)

    def forget(self, before: int) -> None:
        """Drop the slots before a time, but for the latest few intervals."""
        slots, kept = self.slots, sum(slot.intervals for slot in self.slots)
        while slots and slots[0].number < before // _SLOT:
            kept -= slots[0].intervals
            if kept < _FEWEST:
                return
            del slots[0]


class Activity:
    """The traffic of all channels, over the last ``window`` seconds; None for no limit.

    With a window, which is for live views, channels that were silent longest are forgotten.
    """

    def __init__(self, window: float | None = None) -> None:
        self._window = None if window is None else round(window * 1e9)
        self._channels = BoundedDict[str, _Channel](MOST_FLOWS if window else sys.maxsize)

    def __len__(self) -> int:
        """Return the number of channels."""
        return len(self._channels)

    def add(self, packet: Packet) -> None:
        """Count a packet."""
        channel = self._channels.use(packet.channel)
        if channel is None:
            channel = self._channels[packet.channel] = _Channel()
        _, payload, time, _, _, whole_bytes, _, _ = packet
        size = len(payload) if whole_bytes is None else whole_bytes
        channel.add(time, size, time // _SLOT if self._window else 0)

    def clear(self) -> None:
        """Count from zero again."""
        self._channels.clear()

    def rates(self) -> dict[str, float]:
        """Return the rate [Hz] of each channel that has had two messages, over the whole time."""
        flows = {name: _flow(channel) for name, channel in self._channels.items()}
        return {name: flow.rate for name, flow in flows.items() if flow.rate is not None}

    def flow(self, name: str, now: int) -> Flow | None:
        """Return the traffic of a channel at a time; None before its first message."""
        channel = self._channels.get(name)
        if channel is None:
            return None
        if self._window is None:
            return _flow(channel)
        channel.forget(now - self._window)
        waited, intervals = _sums(channel)
        patience = max(SILENT_AFTER, _SILENT_PERIODS * waited // max(1, intervals))
        if now - channel.last_time > patience:
            totals = channel.messages, channel.bytes, channel.last_time
            return Flow(*totals, rate=0.0, bandwidth=0.0)
        return _flow(channel)


def _sums(channel: _Channel) -> tuple[int, int]:
    """The time between the messages [ns], and the number of intervals."""
    return sum(s.waited for s in channel.slots), sum(s.intervals for s in channel.slots)


def _flow(channel: _Channel) -> Flow:
    slots, (waited, intervals) = channel.slots, _sums(channel)
    totals = channel.messages, channel.bytes, channel.last_time
    if not waited:
        return Flow(*totals)
    jitter = max(slot.longest for slot in slots) - min(slot.shortest for slot in slots)
    return Flow(
        *totals,
        rate=intervals * 1e9 / waited,
        jitter=jitter / 1e9 if intervals > 1 else None,
        bandwidth=sum(slot.bytes for slot in slots) * 1e9 / waited,
    )


def settled(
    monitor: "BusMonitor", wait: float | None, *, hz: bool
) -> "tuple[Graph, Mapping[str, float] | None]":
    """Return the graph of a bus, and the rates of its channels [Hz]; None without ``hz``.

    ``wait`` is the time to listen [s]; None for as long as needed.
    """
    activity = Activity()
    wait = _MEASURED if hz and wait is None else wait
    graph = monitor.settle(wait=wait, count=activity.add)
    return graph, activity.rates() if hz else None
