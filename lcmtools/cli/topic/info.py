"""``lcmtools info``."""

from lcmtools.cli.bus import looking_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import write_document, write_lines
from lcmtools.observe.measuring.measure import watch_counters
from lcmtools.observe.reading.selection import selected_topics
from lcmtools.observe.reports import topic_report


@subcommand("info", json_option, looking_options)
@examples("info /husky0/odometry", "info EXAMPLE /chatter --json", "info '/*/odometry'")
@argument("topics", nargs=-1, required=True, completer="bus:topics")
@option("--wait", type=duration, help="Measure rates for this long (else as nodes announce them).")
@flag("-v", "--verbose", help="Show fingerprints and command lines too.")
def command(topics: tuple[str, ...], *, wait: float | None, verbose: bool, as_json: bool) -> None:
    """Show a topic's type, publishers and subscribers: node, host and process.

    Counters for each: messages, bytes, messages dropped from a full queue, queue depth, rate, and
    time of the last message. For plain LCM programs these are observed values; those that listen
    are named, for their channels are not seen. For publishers also the number of messages lost on
    the way here, by sequence numbers. TOPIC may be a pattern.
    """
    names = looking_names()
    with open_monitor("info") as monitor:
        from lcmtools.observe.reading.senders import listening_programs

        graph, counters = watch_counters(monitor, topics, wait, names, with_messages=verbose)
        listeners = listening_programs(graph, monitor.url)
    found = selected_topics(graph, topics, names)
    if as_json:
        write_document([topic_report.record(topic, counters, listeners) for topic in found])
        return
    for topic in found:
        write_lines([f"Topic: {topic.name}"] if len(found) > 1 else [])
        write_lines(topic_report.rows(topic, counters, listeners, verbose=verbose))
