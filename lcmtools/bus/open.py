"""The choice of the code for a bus, by its URL. Nothing above needs to know which one it is."""

from lcmtools.bus.base import Bus
from lcmtools.bus.url import BusUrl


def open_bus(url: BusUrl) -> Bus:
    """Return a connection of nodes to a bus.

    Raises:
        BusError: It cannot be reached, with what to do.
        MissingExtra: The package for it is not installed.
    """
    if url.provider == "zenoh":
        from lcmtools.bus.zenoh_bus import ZenohBus

        return ZenohBus(url)
    from lcmtools.bus.lcm_bus import LcmBus

    return LcmBus(url)
