"""The topics on other buses of this user's programs.

Belongs here: reading other buses for a moment. Must not judge.
"""

import contextlib
import time
from collections.abc import Iterable
from dataclasses import replace

from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.url import parse_url
from lcmtools.doctor.connecting import loose_ends
from lcmtools.doctor.evidence import LcmProcess
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Role
from lcmtools.names import is_hidden

_MOST = 3  # buses that are looked at
_LISTEN = 0.2  # [s]


def with_topics(processes: Iterable[LcmProcess], graph: Graph) -> tuple[LcmProcess, ...]:
    """The processes, those on other buses with the topics there.

    Other buses are looked at only if a subscription or all nodes are missing on this one.
    """
    every = tuple(processes)
    buses = sorted({process.bus for process in every if process.bus})
    is_missed = any(loose_ends(graph, Role.SUBSCRIBER)) or not any(
        not node.tool for node in graph.nodes
    )
    if not is_missed:
        return every
    topics = {bus: _topics(bus) for bus in buses[:_MOST]}
    return tuple(replace(p, topics=topics.get(p.bus, ())) for p in every)


def _topics(bus: str) -> tuple[str, ...]:
    """The topics of another bus."""
    with (
        contextlib.suppress(LcmtoolsError),
        QuickProbe(parse_url(f"udpm://{bus}?ttl=0")) as quick_probe,
    ):
        time.sleep(_LISTEN)
        graph = quick_probe.graph()
        announced = {e.topic for node in graph.nodes for e in node.having(Role.PUBLISHER)}
        seen = {traffic.channel for traffic in graph.traffic}
        return tuple(sorted(name for name in announced | seen if not is_hidden(name)))
    return ()
