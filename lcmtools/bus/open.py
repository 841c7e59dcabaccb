"""The choice of a bus's implementation by its URL. Nothing above needs to know it."""

import os

from lcmtools.bus.base import LOCKSTEP, Bus
from lcmtools.bus.url import BusUrl


def open_bus(url: BusUrl) -> Bus:
    """Return a connection to a bus, for nodes.

    Raises:
        BusError: It cannot be reached; the error says what to do.
        MissingExtra: The package for it is not installed.
    """
    if url.provider == "zenoh":
        from lcmtools.bus.zenoh.bus import ZenohBus

        return ZenohBus(url)
    if url.is_multicast:
        from lcmtools.bus.udp_bus import UdpBus

        return UdpBus(url)
    if url.provider == "tcpq" and os.environ.get(LOCKSTEP):
        from lcmtools.bus.step_bus import StepBus

        return StepBus(url)
    from lcmtools.bus.lcm_bus import LcmBus

    return LcmBus(url)
