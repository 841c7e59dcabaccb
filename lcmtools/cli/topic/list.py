"""``lcmtools list``."""

from collections.abc import Mapping
from typing import NamedTuple

from lcmtools.cli.bus import looking_pattern, open_monitor
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import columns, data, show
from lcmtools.errors import UsageError
from lcmtools.graph.model import Topic
from lcmtools.observe.activity import settled
from lcmtools.observe.describe import by_computer, type_text


class _ListOptions(NamedTuple):
    """The topics that are listed, and the form."""

    published: bool  # those that are published are listed
    subscribed: bool
    verbose: bool  # in rostopic's sections
    types: bool  # each with its type
    rates: Mapping[str, float] | None  # [Hz] by topic; None where they are not shown

    def has(self, topic: Topic) -> bool:
        """Return whether a topic is listed at all."""
        has_publisher = bool(topic.publishers or topic.traffic)
        return (self.published and has_publisher) or (self.subscribed and bool(topic.subscribers))

    def rate_text(self, topic: Topic) -> str:
        """Return the rate as it is printed."""
        rate = (self.rates or {}).get(topic.name)
        return "-" if rate is None else f"{rate:.2f} Hz"


@subcommand("list", all_option, json_option, looking_options)
@examples("list", "list -t /husky0", "list --hz '*/odometry'")
@argument("namespace", default="", completer="bus:namespaces")
@option("-v", "--verbose", is_flag=True, help="Show types and counts, as rostopic list -v.")
@option("-p", "published", is_flag=True, help="Only topics that are published.")
@option("-s", "subscribed", is_flag=True, help="Only topics that are subscribed to.")
@option("-t", "--show-types", is_flag=True, help="Show each topic's type.")
@option("--hz", is_flag=True, help="Measure rates for a second.")
@option("--host", "by_hosts", is_flag=True, help="Group the topics by computer.")
@option("-c", "--count-topics", is_flag=True, help="Print only the number of topics.")
@option("--wait", type=duration, help="Observe plain LCM programs for this long.")
def command(
    namespace: str,
    *,
    verbose: bool,
    published: bool,
    subscribed: bool,
    show_types: bool,
    hz: bool,
    by_hosts: bool,
    count_topics: bool,
    wait: float | None,
    show_all: bool,
    as_json: bool,
) -> None:
    """List the topics on the bus: those of nodes, and the channels of plain LCM programs.

    NAMESPACE selects a topic or the topics in a namespace. In quotes it may be a pattern: * is any
    characters but /, ** any characters, ? one.
    """
    if published and subscribed:
        raise UsageError("-p and -s exclude each other", "leave out both for all topics")
    with open_monitor("list") as monitor:
        (graph, rates), url = settled(monitor, wait, hz=hz), monitor.url
    options = _ListOptions(not subscribed, not published, verbose, show_types, rates)
    pattern = looking_pattern(namespace, hidden=show_all)
    known = [graph.topic(name) for name in graph.topic_names() if pattern.covers(name)]
    topics = [topic for topic in known if options.has(topic)]
    if count_topics:
        data(str(len(topics)))
        return
    rows = _hosts(topics, options) if by_hosts else _rows(topics, options)
    none = f"no topics{f' in {namespace}' if namespace else ''} on {url}"
    show([_record(topic, options) for topic in topics], rows, as_json=as_json, none=none)


def _rows(topics: list[Topic], options: _ListOptions) -> list[str]:
    if options.verbose:
        return _verbose(topics, options)
    names = [f"{t.name} [{type_text(t)}]" if options.types else t.name for t in topics]
    if options.rates is None:
        return names
    return list(columns([*zip(names, map(options.rate_text, topics), strict=True)]))


def _hosts(topics: list[Topic], options: _ListOptions) -> list[str]:
    """As rostopic list --host: the same for each computer, indented."""
    rows = []
    for host, there in by_computer(topics).items():
        if shown := [topic for topic in there if options.has(topic)]:
            rows += [f"Host [{host}]:", *(f"  {row}".rstrip() for row in _rows(shown, options))]
    return rows


def _verbose(topics: list[Topic], options: _ListOptions) -> list[str]:
    published = {topic: len(topic.publishers) + len(topic.foreign) for topic in topics}
    subscribed = {topic: len(topic.subscribers) for topic in topics}
    sections = (
        (options.published, "Published topics:", published, "publisher"),
        (options.subscribed, "Subscribed topics:", subscribed, "subscriber"),
    )
    rows = [""]
    for is_shown, title, counts, noun in sections:
        if is_shown:
            rows += [title, *(_row(t, n, noun, options) for t, n in counts.items() if n), ""]
    return rows


def _row(topic: Topic, count: int, noun: str, options: _ListOptions) -> str:
    rate = "" if options.rates is None else f", {options.rate_text(topic)}"
    return f" * {topic.name} [{type_text(topic)}] {count} {noun}{'s' if count != 1 else ''}{rate}"


def _record(topic: Topic, options: _ListOptions) -> dict[str, object]:
    record: dict[str, object] = {
        "topic": topic.name,
        "type": type_text(topic),
        "publishers": [node.name for node, _ in topic.publishers],
        "subscribers": [node.name for node, _ in topic.subscribers],
        "other_senders": [str(seen.sender) for seen in topic.foreign],
    }
    return record if options.rates is None else {**record, "rate": options.rates.get(topic.name)}
