"""The configuration of a Zenoh session, from a URL. Pure values.

A session listens only on this computer's loopback, unless the URL has an address or a network.
"""

import sys
from collections.abc import Mapping

from lcmtools.bus.zenoh.url import LOOPBACK, ZenohPlace

_LOOPBACK_INTERFACE = "lo0" if sys.platform == "darwin" else "lo"
_MARK = "6c636d746f6f6c73"  # "lcmtools": the first half of the ids of its sessions
_DELAY_MS = 300  # wait if no other program answers; others answer in milliseconds, if busy later
_US = 1_000_000
# A small message waits for what was passed on before it: little on a slow line.
_SMALL_BATCHES = {
    "transport/link/tx/batch_size": 4096,
    "transport/link/tx/queue/size/data_low": 1,
}
_LEASE_MS = 4000  # after this silence a connection counts as lost


def is_own(session: str) -> bool:
    """Return whether a session's id belongs to a program of lcmtools."""
    return session.startswith(_MARK)


def settings_of(place: ZenohPlace, identifier: int) -> Mapping[str, object]:
    """Return the settings of a session, by their paths in Zenoh's configuration."""
    name = {"id": f"{_MARK}{identifier:016x}"}
    if place.file:
        return {**name, **_SMALL_BATCHES}
    common = {
        **name,
        **(_SMALL_BATCHES if place.is_remote else {}),
        "transport/link/tx/queue/congestion_control/block/wait_before_close": place.patience * _US,
        "transport/link/tx/lease": _LEASE_MS,
    }
    if place.is_client:
        return {
            **common,
            "mode": "client",
            "connect/endpoints": [f"tcp/{host}" for host in place.hosts],
            "connect/timeout_ms": 1500,
            "scouting/multicast/enabled": False,
        }
    listen = [f"tcp/{place.listen}"] if place.listen else []
    is_here = place.interface == LOOPBACK
    if not place.hosts:
        listen.append("tcp/127.0.0.1:0" if is_here else "tcp/0.0.0.0:0")
    return {
        **common,
        "mode": "peer",
        "connect/endpoints": [f"tcp/{host}" for host in place.hosts],
        "listen/endpoints": listen,
        # if several programs have one address, the first listens; when it ends, the next does
        "listen/exit_on_failure": False,
        "listen/timeout_ms": -1,
        "scouting/multicast/enabled": not place.hosts,
        "scouting/multicast/interface": _LOOPBACK_INTERFACE if is_here else place.interface,
        "scouting/multicast/address": place.group,
        # else a program that is also on the network would report others there
        "scouting/gossip/enabled": not is_here or bool(place.hosts),
        "scouting/delay": _DELAY_MS,
    }
