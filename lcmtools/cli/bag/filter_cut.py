"""``lcmtools bag filter``, ``cut`` and ``downsample``: fewer messages."""

from lcmtools.bag import edits
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.latched import LatchedTopics, part_of
from lcmtools.bag.summary import known_nodes
from lcmtools.bag.times import LogTime
from lcmtools.cli.bag.common import (
    exclude_option,
    made_options,
    places,
    topic_choice,
    topics_option,
    window_options,
    write,
)
from lcmtools.cli.bus import notify
from lcmtools.cli.declare import argument, examples, flag, option, rate, subcommand, whole_number
from lcmtools.cli.declare import duration as time_span
from lcmtools.errors import UsageError
from lcmtools.messages.filter import Filter
from lcmtools.observe.reading.log_file import LogFile

_Topics = tuple[str, ...]


@subcommand("filter", made_options)
@examples(
    "bag filter ride.lcmlog out.lcmlog 'm.pose.pose.position.x > 1' -t /husky0/odometry",
    "bag filter ride.lcmlog out.lcmlog -x '**/image' -s 10s -e end-1m",
    "bag filter ride.lcmlog out.lcmlog /cmd_vel 'm.linear.x > 0' --keep-others",
)
@places
@argument("words", metavar="[[TOPIC] EXPR]", nargs=-1)
@flag("--keep-others", help="Keep the messages of all topics without a condition.")
@topics_option
@exclude_option
@window_options
def filter_(
    source: str,
    target: str,
    words: tuple[str, ...],
    *,
    keep_others: bool,
    wanted: _Topics,
    excluded: _Topics,
    start: LogTime | None,
    end: LogTime | None,
    force: bool,
    as_json: bool,
) -> None:
    """Write the messages that meet a condition to another log.

    EXPR is an expression as in echo --filter: m is the message. It must fit every selected topic,
    so name the TOPIC before it, or select topics with -t. With --keep-others it is a condition for
    these, and all other topics are kept. A message that cannot be decoded does not match.
    """
    *topics, expression = words or ("",)
    if len(topics) > 1:
        hint = "write TOPIC EXPR, or -t for each of several topics"
        raise UsageError(f"too many arguments: {topics[1]}", hint)
    judged = TopicChoice((*wanted, *topics))
    if keep_others and not (judged.wanted and expression):
        raise UsageError(
            "--keep-others keeps the topics without a condition", "name a topic and its condition"
        )
    condition = Filter(expression) if expression else None
    wanted = () if keep_others else tuple(judged.wanted)
    with LogFile(source) as log:
        span, found = part_of(log, start, end, notify=notify)
        found = edits.chosen(found, topic_choice(log, wanted, excluded))
        if condition:
            only = topic_choice(log, tuple(judged.wanted), ()) if keep_others else None
            found = edits.matching(found, condition, known_nodes(log).types_of, only)
        write(target, found, log, force=force, as_json=as_json, between=span)


@subcommand("cut", made_options)
@examples("bag cut ride.lcmlog start.lcmlog -e 10s", "bag cut a.lcmlog b.lcmlog -s end-1m -d 10s")
@places
@window_options
@option("-d", "--duration", type=time_span, help="Maximum duration.")
def cut(
    source: str,
    target: str,
    *,
    start: LogTime | None,
    end: LogTime | None,
    duration: float | None,
    force: bool,
    as_json: bool,
) -> None:
    """Write the part of a log between two times to another log."""
    with LogFile(source) as log:
        span, found = part_of(log, start, end, duration=duration, notify=notify)
        write(target, found, log, force=force, as_json=as_json, between=span)


@subcommand("downsample", made_options)
@examples("bag downsample a.lcmlog b.lcmlog --rate 10 -t /scan", "bag downsample a b --every 5")
@places
@topics_option
@exclude_option
@window_options
@option("-r", "--rate", "most", type=rate, help="Maximum rate of each topic [Hz].")
@option("--every", metavar="N", type=whole_number(1), help="Keep every N-th message of each topic.")
def downsample(
    source: str,
    target: str,
    *,
    wanted: _Topics,
    excluded: _Topics,
    start: LogTime | None,
    end: LogTime | None,
    most: float | None,
    every: int | None,
    force: bool,
    as_json: bool,
) -> None:
    """Reduce the rate of topics; other topics are copied unchanged.

    Latched topics are reduced only if -t names them.
    """
    if not (most or every):
        raise UsageError("the new rate is missing", "add --rate or --every")
    with LogFile(source) as log:
        span, found = part_of(log, start, end, notify=notify)
        topics = topic_choice(log, wanted, excluded)
        if not wanted:  # each message of a latched topic is its state from then on
            latched = sorted(LatchedTopics(log.announcements()).ever())
            topics = TopicChoice((), (*topics.excluded, *latched))
        found = edits.thinned(found, topics, every=every or 1, rate=most or 0.0)
        write(target, found, log, force=force, as_json=as_json, between=span)
