"""``lcmtools info``."""

import click

from lcmtools.cli.describe import fingerprint_rows, node_text, program_text, type_text
from lcmtools.cli.find import find_topic
from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch
from lcmtools.cli.output import document, lines
from lcmtools.graph.model import Endpoint, Node, Topic


@click.command("info", context_settings=CONTEXT)
@click.argument("topics", nargs=-1, required=True)
@json_option
@bus_options
def command(topics: tuple[str, ...], *, as_json: bool) -> None:
    """Show a topic's type, who publishes it and who subscribes to it: node, host and process.

    \b
    Examples:
      lcmtools info /husky0/odometry
      lcmtools info EXAMPLE
    """  # noqa: D301 - \b is click's mark
    with open_watch("info") as watch:
        graph = watch.settle()
        found = [find_topic(graph, name) for name in topics]
    if as_json:
        document([_record(topic) for topic in found])
        return
    for topic in found:
        lines(_text(topic))


def _text(topic: Topic) -> list[str]:
    """As rostopic info prints it, with the process beside each node."""
    rows = [f"Type: {type_text(topic)}"]
    if not topic.types:
        rows += fingerprint_rows(topic)
    accepted = {name for _, e in topic.subscribers for name in e.types[1:]} - set(topic.types)
    if accepted:
        rows.append(f"Also accepted: {', '.join(sorted(accepted))}")
    rows += ["", *_section("Publishers", topic.publishers, topic), ""]
    rows += [*_section("Subscribers", topic.subscribers, None), "", ""]
    return rows


def _section(
    title: str, endpoints: tuple[tuple[Node, Endpoint], ...], programs_of: Topic | None
) -> list[str]:
    rows = [f" * {node_text(node)}" for node, _ in endpoints]
    if programs_of:
        rows += [f" * {program_text(seen)}" for seen in programs_of.foreign]
    return [f"{title}: ", *rows] if rows else [f"{title}: None"]


def _record(topic: Topic) -> dict[str, object]:
    return {
        "topic": topic.name,
        "type": type_text(topic),
        "types": list(topic.types),
        "fingerprints": [f"{value:#018x}" for value in topic.fingerprints],
        "publishers": [_endpoint(node, endpoint) for node, endpoint in topic.publishers],
        "subscribers": [_endpoint(node, endpoint) for node, endpoint in topic.subscribers],
        "other_publishers": [
            {
                "program": program_text(seen),
                "sender": str(seen.sender),
                "messages": seen.messages,
                "rate": seen.rate(),
            }
            for seen in topic.foreign
        ],
    }


def _endpoint(node: Node, endpoint: Endpoint) -> dict[str, object]:
    return {
        "node": node.name,
        "host": node.host,
        "pid": node.pid,
        "stale": bool(node.stale),
        "types": list(endpoint.types),
        "depth": endpoint.depth,
        "messages": endpoint.messages,
        "bytes": endpoint.bytes,
        "drops": endpoint.drops,
    }
