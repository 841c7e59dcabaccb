"""The clock that arrivals go by: the computer's, or simulated time."""

from lcmtools.clock import join_stamp
from lcmtools.errors import DecodeError
from lcmtools.graph.model import Graph
from lcmtools.messages.codec import decode
from lcmtools.wire.packet import Packet

CLOCK = "/clock"
"""The topic of a simulator's time."""


class ArrivalClock:
    """The clock that tells when a packet came.

    Args:
        is_simulated: The time is what ``/clock`` last said, as for nodes with _use_sim_time.

    Attributes:
        now: The simulated time [ns]; None before the first message on ``/clock``.
    """

    def __init__(self, *, is_simulated: bool) -> None:
        self.is_simulated = is_simulated
        self.now: int | None = None

    def learn(self, packet: Packet) -> bool:
        """Take the time from a message on ``/clock``; True when simulated time goes back."""
        if not self.is_simulated or packet.channel != CLOCK:
            return False
        from lcmtools.types.rosgraph_msgs import Clock

        try:
            stamp = decode(Clock, packet.payload).clock
        except DecodeError:
            return False  # of another type
        before, self.now = self.now, join_stamp(stamp.sec, stamp.nsec)
        return before is not None and self.now < before

    def time(self, packet: Packet) -> int | None:
        """Return when a packet came [ns]; None where simulated time is not known yet."""
        return self.now if self.is_simulated else packet.time


def is_simulated(graph: Graph) -> bool:
    """Return whether a simulator keeps the time of a bus: ``/clock`` is published."""
    clock = graph.topic(CLOCK)
    return any(not node.stale for node, _ in clock.publishers) or bool(clock.traffic)
