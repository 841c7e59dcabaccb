"""The time that wtf's rules take for the evidence of a large fleet: 1,000 topics, 200 nodes.

And for that of one node with thousands of endpoints, none of which is connected.

Usage: python bench/fleet.py
"""

import time
from dataclasses import replace
from itertools import product

from lcmtools.doctor.evidence import Evidence, Listener, SenderFacts, Stream
from lcmtools.doctor.report import text
from lcmtools.doctor.rules import RULES, examine
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.wire.packet import Sender

ROBOTS, SECOND = 100, 1_000_000_000
NOW = 1_000_000 * SECOND
TYPE = "nav_msgs/Odometry"


def endpoint(topic: str, role: Role) -> Endpoint:
    """A publisher or subscription of odometry, which has seen messages."""
    depth, number = 10 if role is Role.SUBSCRIBER else 0, fingerprint(message_class(TYPE))
    return Endpoint(topic, role, (TYPE,), (number,), "", depth, 5000, 50, 0, NOW, 5000, 9, 9)


def robot(number: int, space: str) -> list[NodeInfo]:
    """A driver with sensors, and a controller that misses some of its topics."""
    sensors = [endpoint(f"/robot{number}/sensor{n}", Role.PUBLISHER) for n in range(7)]
    driver = (*sensors, endpoint(f"/robot{number}/velocity_cmd", Role.SUBSCRIBER))
    controller = (
        endpoint(f"{space}/sensor0", Role.SUBSCRIBER),
        endpoint(f"{space}/desired_velocity", Role.SUBSCRIBER),
        endpoint(f"{space}/velocity_command", Role.PUBLISHER),
    )
    return [
        NodeInfo(f"{where}/{name}", f"{name}{number}", "here", number + start, NOW - 100 * SECOND,
             f"run {name}", endpoints=ends, sender=Sender("10.0.0.1", number + start), sent=NOW)
        for where, name, start, ends in (
            (f"/robot{number}", "driver", 1000, driver), (space, "controller", 2000, controller))
    ]  # fmt: skip


def evidence(*, lost: bool, plain: bool) -> Evidence:
    """A fleet where all is well but for nothing that steers it, or all controllers are lost.

    If ``plain``, the drivers are programs that are no nodes.
    """
    nodes = tuple(
        node for n in range(ROBOTS) for node in robot(n, f"/lost{n}" if lost else f"/robot{n}")
    )
    published = [(node, e) for node in nodes for e in node.having(Role.PUBLISHER)]
    traffic = tuple(
        Traffic(e.topic, node.sender, e.fingerprints, 50, 5000, NOW - SECOND, NOW)
        for node, e in published
    )
    times = tuple(NOW - n * SECOND // 50 for n in range(50, 0, -1))
    streams = tuple(Stream(e.topic, n.sender, n.name, times, 100, 5000) for n, e in published)
    if plain:
        nodes = tuple(node for node in nodes if node.name.endswith("controller"))
    graph = Graph(nodes, traffic, NOW)
    return Evidence(
        "udpm://239.255.76.67:7667?ttl=0",
        graph=graph,
        before=graph._replace(time=NOW - SECOND),
        listened=1.0,
        senders=tuple(SenderFacts(n.sender, n.name, messages=500) for n in nodes if n.sender),
        streams=streams,
        listeners=tuple(Listener(n.name, n.pid, 0, is_node=True) for n in nodes),
    )


def one_node(count: int) -> Evidence:
    """A node with so many publishers and subscriptions."""
    ends = tuple(endpoint(f"/big/topic{n}", Role(n % 2)) for n in range(count))
    node = NodeInfo("/big/node", "b", "here", 1, NOW - 100 * SECOND, endpoints=ends, sent=NOW)
    graph = Graph((node,), (), NOW)
    return replace(evidence(lost=False, plain=False), graph=graph, before=graph, streams=())


def main() -> None:
    """Print the time of each rule that takes long, and of all."""
    cases = list(product((False, True), repeat=2))
    looks = {
        f"lost={lost}, plain={plain}": evidence(lost=lost, plain=plain) for lost, plain in cases
    }
    looks |= {f"{count} endpoints": one_node(count) for count in (2_000, 10_000)}
    for title, found in looks.items():
        topics = len(found.graph.topic_names())
        start = time.process_time()
        findings = examine(found)
        total = time.process_time() - start
        print(f"{len(found.graph.nodes)} nodes, {topics} topics, {title}: {total:.2f} s of CPU")
        for rule in RULES:
            start = time.process_time()
            rule.examine(replace(found))
            if (seconds := time.process_time() - start) > 0.1 * total:
                print(f"  {rule.id} alone: {seconds:.2f} s")
        print(f"  {len(text(findings))} lines")


if __name__ == "__main__":
    main()
