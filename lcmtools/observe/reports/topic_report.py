"""A topic as lines of text and as values for JSON."""

from collections.abc import Iterable, Sequence

from lcmtools.graph.model import Endpoint, NodeInfo, Topic, Traffic
from lcmtools.observe.measuring.counters import Counters
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reading.senders import Program
from lcmtools.observe.reports.describe import (
    fingerprint_rows,
    node_text,
    program_texts,
    topic_kinds,
    type_text,
    types_json,
)
from lcmtools.observe.reports.program_report import listeners_json, listeners_text

_UNSEEN = "they listen to the bus; on which channels is not seen"


def to_lines(
    topic: Topic, counters: Counters, listeners: Sequence[Program] | None, *, verbose: bool
) -> list[str]:
    """Return the lines of rostopic info, each node with its process and, below, its counters.

    ``listeners`` are programs that may receive it, too; None if such programs are not seen.
    """
    found = [f"Type: {type_text(topic)}"]
    if not topic.types or verbose:
        found += fingerprint_rows(topic)
    accepted = {name for _, e in topic.subscribers for name in e.types[1:]} - set(topic.types)
    if accepted:
        found.append(f"Also accepted: {', '.join(sorted(accepted))}")
    published = _nodes(topic.publishers, counters, verbose=verbose)
    for rows_of_node, (node, _) in zip(published, topic.publishers, strict=True):
        rows_of_node.extend(_lost(counters.lost(node)))
    published += [
        [text, counters.of_program(seen), *_lost(counters.lost(seen))]
        for text, seen in _programs(topic)
    ]
    subscribed = _nodes(topic.subscribers, counters, verbose=verbose)
    found += ["", *_section("Publishers", published), ""]
    if listeners is None and not subscribed:
        return [*found, "Subscribers: not known of programs that are no nodes", "", ""]
    names = listeners_text(listeners)
    subscribed += [[f"not known: {names}", _UNSEEN]] if names else []
    return [*found, *_section("Subscribers", subscribed), "", ""]


def to_json(
    topic: Topic, counters: Counters, listeners: Sequence[Program] | None
) -> dict[str, object]:
    """Return the same for JSON."""
    return {
        "topic": topic.name,
        **types_json(topic_kinds(topic), topic.name),
        "fingerprints": [f"{value:#018x}" for value in topic.fingerprints],
        "publishers": [
            {**counters.to_json(node, e), **_lost_json(counters.lost(node))}
            for node, e in topic.publishers
        ],
        "subscribers": [counters.to_json(node, e) for node, e in topic.subscribers],
        "other_publishers": [
            {
                "program": text,
                "sender": seen.sender and str(seen.sender),
                "messages": seen.messages,
                "bytes": seen.bytes,
                "rate": seen.rate(),
                "last_time": seen.last_time,
                **_lost_json(counters.lost(seen)),
            }
            for text, seen in _programs(topic)
        ],
        "possible_subscribers": listeners_json(listeners),
    }


def _programs(topic: Topic) -> Iterable[tuple[str, Traffic]]:
    """The programs that are not nodes and send the topic, each with its messages."""
    return zip(program_texts(topic.foreign), topic.foreign, strict=True)


def _nodes(
    endpoints: Sequence[tuple[NodeInfo, Endpoint]], counters: Counters, *, verbose: bool
) -> list[list[str]]:
    """The lines of each node: its description, then its counters."""
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


def _lost_json(loss: Loss | None) -> dict[str, object]:
    """Return the numbers of lost and of sent messages; null if unknown."""
    known = loss if loss and loss.sent else None
    return {"lost": known and known.lost, "lost_of": known and known.sent}
