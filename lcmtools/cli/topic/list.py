"""``lcmtools list``."""

import contextlib

import click

from lcmtools.cli.describe import type_text
from lcmtools.cli.options import (
    CONTEXT,
    all_option,
    bus_options,
    duration,
    json_option,
    open_watch,
)
from lcmtools.cli.output import document, lines, talk
from lcmtools.graph.model import Graph, Topic
from lcmtools.names import is_hidden


@click.command("list", context_settings=CONTEXT)
@click.argument("namespace", default="")
@click.option("-v", "--verbose", is_flag=True, help="Show types and counts, as rostopic list -v.")
@click.option("-t", "--show-types", is_flag=True, help="Show each topic's type.")
@click.option(
    "--wait", type=duration, help="Listen so long for programs that are no lcmtools nodes."
)
@all_option
@json_option
@bus_options
def command(
    namespace: str,
    *,
    verbose: bool,
    show_types: bool,
    wait: float | None,
    show_all: bool,
    as_json: bool,
) -> None:
    """List the topics on the bus: those of nodes at once, and what other LCM programs publish.

    NAMESPACE keeps the topics that are it or stand below it.

    \b
    Examples:
      lcmtools list
      lcmtools list -t /husky0
    """  # noqa: D301 - \b is click's mark
    with open_watch("list") as watch:
        graph = watch.settle(foreign=wait is None)
        if wait is not None:
            with contextlib.suppress(EOFError):  # a log has ended
                for _ in watch.packets(wait):
                    pass
            graph = watch.graph()
        url = watch.url
    topics = [graph.topic(name) for name in _names(graph, namespace, show_all=show_all)]
    if as_json:
        document([_record(topic) for topic in topics])
    elif verbose:
        lines(_verbose(topics))
    elif show_types:
        lines(f"{topic.name} [{type_text(topic)}]" for topic in topics)
    else:
        lines(topic.name for topic in topics)
    if not topics:
        talk(f"no topics{f' in {namespace}' if namespace else ''} on {url}")


def _names(graph: Graph, namespace: str, *, show_all: bool) -> list[str]:
    prefix = "/" + namespace.strip("/") if namespace.strip("/") else ""
    return [
        name
        for name in graph.topic_names()
        if (show_all or not is_hidden(name))
        and (not prefix or name in (prefix, namespace) or name.startswith(f"{prefix}/"))
    ]


def _verbose(topics: list[Topic]) -> list[str]:
    """The sections of rostopic list -v."""
    published = {topic: len(topic.publishers) + len(topic.foreign) for topic in topics}
    subscribed = {topic: len(topic.subscribers) for topic in topics}
    return [
        "",
        "Published topics:",
        *(_row(topic, count, "publisher") for topic, count in published.items() if count),
        "",
        "Subscribed topics:",
        *(_row(topic, count, "subscriber") for topic, count in subscribed.items() if count),
        "",
    ]


def _row(topic: Topic, count: int, noun: str) -> str:
    return f" * {topic.name} [{type_text(topic)}] {count} {noun}{'s' if count != 1 else ''}"


def _record(topic: Topic) -> dict[str, object]:
    return {
        "topic": topic.name,
        "type": type_text(topic),
        "publishers": [node.name for node, _ in topic.publishers],
        "subscribers": [node.name for node, _ in topic.subscribers],
        "other_senders": [str(seen.sender) for seen in topic.foreign],
    }
