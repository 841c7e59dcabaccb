"""The relays known on a bus, as they report themselves."""

import time

from lcmtools.graph.protocol import RELAY_CHANNEL
from lcmtools.graph.relay_report import Link, State, decode_report
from lcmtools.observe.reading.monitor import BusMonitor

_QUIET, _LONGEST = 0.1, 0.5  # [s] without a report, and in all


def known_relays(monitor: BusMonitor) -> list[Link]:
    """Return the relays of a bus, and those that they know of, by their ids; the oldest first."""
    found: dict[str, Link] = {}
    monitor.probe()
    begin = last = time.monotonic()
    while (now := time.monotonic()) - begin < _LONGEST and (now - last < _QUIET or not found):
        for packet in monitor.receive(_QUIET / 2):
            report = decode_report(packet.payload) if packet.channel == RELAY_CHANNEL else None
            for link in report.links if report else ():
                last = now
                known = found.get(link.id)
                if known is None or known.number < link.number:
                    found[link.id] = link
    alive = (link for link in found.values() if link.state is not State.LEFT)
    return sorted(alive, key=lambda link: link.id)
