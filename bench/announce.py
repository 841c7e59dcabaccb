"""The cost to a node of 200 nodes that announce themselves once a second.

Eight node processes run at the same time: four on an empty bus, four on a bus where one sender
announces 199 more nodes, evenly over each second, in lcmtools' own encoding, each with seven
endpoints whose counters go on. Of each four one node is plain, one has asked for the graph once
(``node.graph()``; it follows announcements from then on), and one asks for it each second. The last
has asked once too, but without a channel socket, as on a system without filters: an announcement
wakes it. Shown is the processor time that each process used (liblcm's thread included), as a share
of one core.
"""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import count
from multiprocessing.connection import Connection

from common import Child, bus, child, isolate, parser, show

import lcmtools
from lcmtools.bus.udp_bus import UdpBus
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.node.graph_follower import GraphFollower
from lcmtools.types.fingerprints import FINGERPRINTS

_BUSES = _EMPTY, _FULL = bus(7794), bus(7795)
_ASKING = _NEVER, _ONCE, _EACH_SECOND, _WOKEN = "never", "once", "each second", "once, woken"
_OTHERS = 199
_ENDPOINTS = (
    ("/rosout", "rosgraph_msgs/Log", Role.PUBLISHER),
    ("odometry", "nav_msgs/Odometry", Role.PUBLISHER),
    ("joint_states", "sensor_msgs/JointState", Role.PUBLISHER),
    ("front/scan", "sensor_msgs/LaserScan", Role.PUBLISHER),
    ("cmd_vel", "geometry_msgs/Twist", Role.SUBSCRIBER),
    ("/clock", "rosgraph_msgs/Clock", Role.SUBSCRIBER),
    ("path", "nav_msgs/Path", Role.SUBSCRIBER),
)


def node(connection: Connection, asks: str, url: str) -> None:
    """Child: one node that spins."""
    if asks == _WOKEN:
        # what it would find where there are no filters
        GraphFollower._open_socket = lambda _: None  # type: ignore[method-assign] # noqa: SLF001
    lcmtools.init([], url=url)
    measured = lcmtools.NodeInfo("measured", namespace="/robot0")
    if asks != _NEVER:
        measured.graph()
    if asks == _EACH_SECOND:
        measured.create_timer(1.0, measured.graph)
    connection.send(None)
    lcmtools.spin(measured)
    lcmtools.shutdown()


def announce(connection: Connection, url: str, nodes: int) -> None:
    """Child: announce so many nodes once a second."""
    bus_of_nodes = UdpBus(parse_url(url))
    connection.send(None)
    start = time.monotonic()
    for number, announced in enumerate(announcements(nodes)):
        time.sleep(max(0.0, start + number / nodes - time.monotonic()))
        bus_of_nodes.publish(NODE_CHANNEL, encode_announcement(announced))


def announcements(nodes: int) -> Iterator[Announcement]:
    """The announcements of so many nodes, second after second, without end."""
    present = [_node(number) for number in range(nodes)]
    for second in count():
        for known in present:
            yield Announcement(known._replace(endpoints=_endpoints(known.name, second)))


def _node(number: int) -> NodeInfo:
    name = f"/robot{number}/simple_controller"
    command = f"/usr/bin/python3 -m robots.simple_controller __ns:=/robot{number}"
    return NodeInfo(
        name, f"{number:032x}", "computer", 1000 + number, time.time_ns(), command, ports=(50_000,)
    )


def _endpoints(name: str, second: int) -> tuple[Endpoint, ...]:
    namespace = name.rpartition("/")[0]
    return tuple(
        Endpoint(
            topic if topic.startswith("/") else f"{namespace}/{topic}",
            role,
            (kind,),
            (FINGERPRINTS[kind],),
            depth=10,
            messages=50 * second,
            bytes=36_000 * second,
            last_time=time.time_ns(),
        )
        for topic, kind, role in _ENDPOINTS
    )


def shares(children: list[Child], seconds: float) -> list[float]:
    """The processor time that each child uses meanwhile, in percent of one core."""
    before = [one.processor_time() for one in children]
    start = time.monotonic()
    time.sleep(seconds)
    taken = time.monotonic() - start
    return [
        100 * (one.processor_time() - b) / taken for one, b in zip(children, before, strict=True)
    ]


def main() -> None:
    """Measure and print."""
    options = parser(__doc__)
    options.add_argument("--seconds", type=float, default=20.0)
    options.add_argument("--quick", action="store_true", help="5 seconds: rough figures")
    arguments = options.parse_args()
    seconds = 5.0 if arguments.quick else arguments.seconds
    isolate()
    with ExitStack() as stack:
        stack.enter_context(child(announce, _FULL, _OTHERS)).wait()
        nodes = [stack.enter_context(child(node, asks, url)) for asks in _ASKING for url in _BUSES]
        for one in nodes:
            one.wait()
        time.sleep(3.0)  # until every node has been heard
        used = shares(nodes, seconds)
    show(
        f"Processor share of one node, percent of a core, over {seconds:g} s",
        ["asks for the graph", "alone", f"with {_OTHERS} others", "difference", "ratio"],
        [
            [asks, alone, busy, busy - alone, busy / alone]
            for asks, alone, busy in zip(_ASKING, used[::2], used[1::2], strict=True)
        ],
    )


if __name__ == "__main__":
    main()
