"""The commands that write a log anew: ``lcmtools bag filter``, ``cut``, ``merge`` and others."""

from contextlib import ExitStack

from lcmtools.bag import edits
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.latched import LatchedTopics, part_of
from lcmtools.bag.repair import damage_rows, find_damage
from lcmtools.bag.stamps import StampedLog
from lcmtools.bag.summary import known_nodes, log_span
from lcmtools.bag.times import LogTime
from lcmtools.cli.bag.common import (
    exclude_option,
    made_options,
    places,
    stamp_option,
    time_option,
    topic_choice,
    topics_option,
    window_options,
    write,
)
from lcmtools.cli.bus import notify
from lcmtools.cli.declare import argument, examples, flag, option, rate, subcommand, whole_number
from lcmtools.cli.declare import duration as time_span
from lcmtools.cli.output import write_lines, write_note
from lcmtools.errors import UsageError
from lcmtools.messages.filter import Filter
from lcmtools.observe.reading.log_file import LogFile


@subcommand("merge", made_options)
@examples(
    "bag merge husky.lcmlog camera.lcmlog -o both.lcmlog", "bag merge ride*.lcmlog -o ride.lcmlog"
)
@argument("files", metavar="FILE...", nargs=-1, required=True, completer="files")
@option(
    "-o", "--output", "target", metavar="OUT", required=True, completer="files", help="The log."
)
def merge(files: tuple[str, ...], *, target: str, force: bool, as_json: bool) -> None:
    """Merge logs into one, by time."""
    with ExitStack() as stack:
        logs = [stack.enter_context(LogFile(file)) for file in files]
        write(target, edits.merged(logs), *logs, force=force, as_json=as_json)


@subcommand("sort", made_options)
@examples("bag sort mixed.lcmlog sorted.lcmlog", "bag sort a.lcmlog b.lcmlog --by-stamp")
@places
@stamp_option
def sort(source: str, target: str, *, by_stamp: bool, force: bool, as_json: bool) -> None:
    """Sort messages by time; messages with the same time keep their order.

    With --by-stamp the result has the times in the messages. A message without a time in it is
    moved as the one before it.
    """
    with LogFile(source) as log:
        if by_stamp:
            stamped = StampedLog(log)
            found, later = stamped.packets(), stamped.later
        else:
            found, later = edits.in_order(log), 0
        write(target, found, log, force=force, as_json=as_json, later=later)


@subcommand("fix", made_options)
@examples("bag fix broken.lcmlog fixed.lcmlog", "bag fix broken.lcmlog fixed.lcmlog --json")
@places
def fix(source: str, target: str, *, force: bool, as_json: bool) -> int:
    """Write all that can be read from a damaged log to another log, and report what is left out.

    For each part left out, its bytes and the times of the messages around it are shown. The exit
    code is 1 if there are any.
    """
    with LogFile(source) as log:
        damage = find_damage(log)
        more = {"left_out": [part.to_json() for part in damage]}
        manner = {"force": force, "as_json": as_json, "tell_damage": False}  # told below
        write(target, log.packets(), log, more=lambda: more, **manner)
    write_lines([] if as_json else damage_rows(damage))
    if not damage:
        write_note("nothing is damaged")
    return 1 if damage else 0


@subcommand("rename", made_options)
@examples("bag rename a.lcmlog b.lcmlog /odom:=/husky0/odometry", "bag rename a b /a/:=/b/")
@places
@argument("names", metavar="OLD:=NEW...", nargs=-1, required=True)
def rename(source: str, target: str, names: tuple[str, ...], *, force: bool, as_json: bool) -> None:
    """Rename topics; with a / at the end of both names, all topics of a namespace."""
    with LogFile(source) as log:
        nodes = known_nodes(log)
        known = dict.fromkeys(name for block in log.blocks(nodes.add) for name in block.channels)
        announced = [topic.name for topic in nodes.snapshot(0).topics()]
        table = edits.parse_renames(names, known, announced)
        found = edits.renamed(log.packets(), table)
        write(
            target,
            found,
            log,
            force=force,
            as_json=as_json,
            change_node=lambda node: edits.renamed_node(node, table),
        )


@subcommand("shift", made_options)
@examples("bag shift a.lcmlog b.lcmlog --by -1.5s", "bag shift a b --to '2026-11-22 12:00:00'")
@places
@option("--by", metavar="TIME", help="Shift by this much; negative is earlier.")
@time_option("--to", text="Make the log start at this time.")
def shift(
    source: str, target: str, *, by: str | None, to: LogTime | None, force: bool, as_json: bool
) -> None:
    """Change the recorded times of all messages; stamps in the messages stay the same."""
    if (by is None) == (to is None):
        raise UsageError("exactly one of --by and --to is needed", "for example --by -1.5s")
    with LogFile(source) as log:
        span = log_span(log)
        late = to.within(*span) - span[0] if to else edits.parse_shift(str(by))
        found = edits.shifted(log.packets(), late)
        write(target, found, log, force=force, as_json=as_json, later=late)


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
