"""``lcmtools info``."""

from collections.abc import Sequence

from lcmtools.cli.bus import looking_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import document, lines
from lcmtools.graph.model import Endpoint, Node, Topic
from lcmtools.observe.counters import Counters
from lcmtools.observe.describe import fingerprint_rows, node_text, program_text, type_text
from lcmtools.observe.find import find_topic
from lcmtools.observe.losses import Loss
from lcmtools.observe.measure import counted


@subcommand("info", json_option, looking_options)
@examples("info /husky0/odometry", "info EXAMPLE /chatter --json")
@argument("topics", nargs=-1, required=True, completer="bus:topics")
@option("--wait", type=duration, help="Measure rates for this long (else up to 0.5 s).")
@option("-v", "--verbose", is_flag=True, help="Show fingerprints and command lines too.")
def command(topics: tuple[str, ...], *, wait: float | None, verbose: bool, as_json: bool) -> None:
    """Show a topic's type, publishers and subscribers: node, host and process.

    Counters for each: messages, bytes, messages dropped from a full queue, queue depth, rate, and
    time of the last message. For plain LCM programs these are observed values. For publishers also
    the number of messages lost on the way here, by sequence numbers.
    """
    names = looking_names()
    with open_monitor("info") as monitor:
        graph, counters = counted(monitor, topics, wait, names)
    found = [find_topic(graph, name, names) for name in topics]
    if as_json:
        document([_record(topic, counters) for topic in found])
        return
    for topic in found:
        heading = [f"Topic: {topic.name}"] if len(found) > 1 else []
        lines(heading + _text(topic, counters, verbose=verbose))


def _text(topic: Topic, counters: Counters, *, verbose: bool) -> list[str]:
    """As rostopic info prints it, with the process beside each node and its counters below."""
    rows = [f"Type: {type_text(topic)}"]
    if not topic.types or verbose:
        rows += fingerprint_rows(topic)
    accepted = {name for _, e in topic.subscribers for name in e.types[1:]} - set(topic.types)
    if accepted:
        rows.append(f"Also accepted: {', '.join(sorted(accepted))}")
    published = _nodes(topic.publishers, counters, verbose=verbose)
    for rows_of_node, (node, _) in zip(published, topic.publishers, strict=True):
        rows_of_node.extend(_lost(counters.lost(node)))
    published += [
        [program_text(seen), counters.of_program(seen), *_lost(counters.lost(seen))]
        for seen in topic.foreign
    ]
    subscribed = _nodes(topic.subscribers, counters, verbose=verbose)
    rows += ["", *_section("Publishers", published), ""]
    rows += [*_section("Subscribers", subscribed), "", ""]
    return rows


def _nodes(
    endpoints: Sequence[tuple[Node, Endpoint]], counters: Counters, *, verbose: bool
) -> list[list[str]]:
    """Of each node what it is, and what there is to say of it."""
    return [
        [node_text(node), counters.of_endpoint(node, end), *[f"command: {node.command}"] * verbose]
        for node, end in endpoints
    ]


def _lost(loss: Loss | None) -> list[str]:
    return [f"did not arrive here: {loss}, all its topics together"] if loss and loss.lost else []


def _section(title: str, members: Sequence[Sequence[str]]) -> list[str]:
    if not members:
        return [f"{title}: None"]
    rows = [f"{title}: "]
    for name, *details in members:
        rows += [f" * {name}", *(f"     {detail}" for detail in details)]
    return rows


def _record(topic: Topic, counters: Counters) -> dict[str, object]:
    return {
        "topic": topic.name,
        "type": type_text(topic),
        "types": list(topic.types),
        "fingerprints": [f"{value:#018x}" for value in topic.fingerprints],
        "publishers": [
            {**counters.record(node, e), **_lost_record(counters.lost(node))}
            for node, e in topic.publishers
        ],
        "subscribers": [counters.record(node, e) for node, e in topic.subscribers],
        "other_publishers": [
            {
                "program": program_text(seen),
                "sender": str(seen.sender),
                "messages": seen.messages,
                "bytes": seen.bytes,
                "rate": seen.rate(),
                "last_time": seen.last_time,
                **_lost_record(counters.lost(seen)),
            }
            for seen in topic.foreign
        ],
    }


def _lost_record(loss: Loss | None) -> dict[str, object]:
    """The messages that did not arrive, of all that were sent; null where that is not known."""
    known = loss if loss and loss.sent else None
    return {"lost": known and known.lost, "lost_of": known and known.sent}
