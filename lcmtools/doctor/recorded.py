"""The evidence in a log: its messages and its index.

A log contains nothing about this computer or the programs that run now: the rules about those are
not in ``OF_LOGS``.
"""

import math
from dataclasses import replace

from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl
from lcmtools.doctor.collect import clock_of
from lcmtools.doctor.evidence import Evidence, SenderFacts
from lcmtools.doctor.lcm_processes import ProgramNames
from lcmtools.doctor.listening import Listening
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.sources import LogObserver

OF_LOGS = frozenset(
    {
        *("loss", "competing-publishers", "slow-simulator", "type-mismatch", "unknown-type"),
        *("names", "callback-errors", "logged", "not-finite", "quaternions", "covariances"),
        *("stamps", "undecodable", "frames", "damaged-log"),
    }
)
"""The rules that need only messages."""


def collect_log(observer: LogObserver) -> Evidence:
    """Return the evidence in all messages of logs."""
    logs = observer.logs
    url = BusUrl("file", ",".join(str(one.path) for one in logs.files))
    with BusMonitor(url, "wtf", {}, observer) as monitor:
        listening = Listening(monitor.types_of, share=math.inf)
        first = 0
        for packet in monitor.packets():
            first = first or packet.time
            listening.add_packet(packet)
        graph = monitor.graph()
        names = ProgramNames(monitor, listening, graph.nodes, SocketTable())
        return Evidence(
            str(url),
            graph=graph,
            before=graph,
            listened=(graph.time - first) / 1e9,
            senders=tuple(
                SenderFacts(one, names.name(one), messages=loss.sent - loss.lost, lost=loss.lost)
                for one, loss in monitor.losses().items()
            ),
            streams=tuple(replace(one, name=names.name(one.sender)) for one in listening.streams()),
            oddities=listening.oddities(names.name),
            frames=listening.frames(names.name),
            logs=listening.logs(),
            clock=clock_of(listening, graph, names, {}),
            damaged_bytes=logs.damaged_bytes(),
        )
