"""``lcmtools list``."""

from lcmtools.cli.bus import looking_pattern, notify, notify_starting, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options_of_list
from lcmtools.cli.output import write_data, write_result
from lcmtools.errors import UsageError


@subcommand("list", all_option, json_option, looking_options_of_list)
@examples("list", "list -t /husky0", "list --hz '*/odometry'")
@argument("namespace", default="", completer="bus:namespaces")
@flag("-v", "--verbose", help="Show types and counts, as rostopic list -v.")
@flag("-p", "published", help="Only topics that are published.")
@flag("-s", "subscribed", help="Only topics that are subscribed to.")
@flag("-t", "--show-types", help="Show each topic's type.")
@flag("--hz", help="Measure rates for a second.")
@flag("--host", "by_hosts", help="Group the topics by computer.")
@flag("-c", "--count-topics", help="Print only the number of topics.")
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
    with open_monitor("list", asks=True) as monitor:
        from lcmtools.observe.channels.activity import settled  # while the nodes answer
        from lcmtools.observe.reading.senders import listening_programs
        from lcmtools.observe.reports.topic_list_report import TopicList

        (graph, rates), url = settled(monitor, wait, hz=hz), monitor.url
        is_told = subscribed or verbose or as_json
        listeners = listening_programs(graph, url) if is_told else None
    pattern = looking_pattern(namespace, hidden=show_all)
    listed = TopicList(not subscribed, not published, verbose, show_types, rates, listeners)
    known = [graph.topic(name) for name in graph.topic_names() if pattern.covers(name)]
    topics = list(filter(listed.has, known))
    if count_topics:
        write_data(str(len(topics)))
        return
    rows = listed.rows_by_host(topics) if by_hosts else listed.to_lines(topics)
    none = f"no topics{f' in {namespace}' if namespace else ''} on {url}"
    write_result(list(map(listed.to_json, topics)), rows, as_json=as_json, none=none)
    if subscribed and listeners and not verbose:
        from lcmtools.observe.reports.program_report import listeners_text

        notify(f"it is not seen to which channels these listen: {listeners_text(listeners)}")
    notify_starting(graph, url)
