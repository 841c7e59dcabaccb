"""``lcmtools echo``."""

import sys
from collections import deque
from itertools import islice
from typing import Any

import click

from lcmtools.cli.bus import chosen_logs, looking_names, notify, notify_damage, open_monitor
from lcmtools.cli.declare import (
    argument,
    duration,
    examples,
    flag,
    option,
    subcommand,
    together,
    whole_number,
)
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import clearing, may_wait, on_screen, write_data
from lcmtools.errors import UsageError
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import parse_path
from lcmtools.messages.plain import View
from lcmtools.messages.registry import means_type, message_class
from lcmtools.messages.text import Writer
from lcmtools.observe.formatter import DisplayOptions, Form, MessageFormatter
from lcmtools.observe.reading.arrivals import TOGETHER, ArrivalStream, taken, taken_together
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.logs import Logs
from lcmtools.observe.reading.selection import select_topics
from lcmtools.packages import provide_recorded_types

_FORMS: dict[str, Form] = {"--json": "json", "--csv": "csv", "--flow-style": "flow", "--raw": "raw"}
_SHORT = 200  # elements of an array on a terminal
_MORE = "... {} more, which --full-length shows"

display_options = together(
    option(
        "--field",
        "fields",
        metavar="PATH",
        multiple=True,
        help="Show this field; may be repeated.",
        completer="messages:fields",
    ),
    option("--filter", "condition", metavar="EXPR", help="Only messages for which this is true."),
    flag("--noarr", "--no-arr", help="Show only the type and length of arrays."),
    flag("--nostr", "--no-str", help="Show only the length of strings."),
    option(
        "-l",
        "--truncate-length",
        "longest",
        metavar="N",
        type=whole_number(1),
        help="Truncate arrays and strings to N elements.",
    ),
    flag("-f", "--full-length", help="Show long arrays in full on a terminal, too."),
    flag("--offset", help="Show times relative to the message's arrival."),
    option("-w", "width", metavar="N", type=whole_number(2), help="Print numbers with width N."),
    flag("-p", "--csv", "as_csv", help="Print comma-separated values."),
    flag("--flow-style", "as_flow", help="Print each message on one line."),
    flag("--raw", help="Print the payload in hexadecimal."),
)
"""The options whose values ``display`` takes."""

_NAP = 0.02  # [s] that those of a stream may wait for each other on their way to a screen: a frame
_ALL_TOPICS = "**"


@subcommand("echo", json_option, looking_options)
@examples(
    "echo /husky0/odometry",
    "echo /husky0/odometry/pose.pose.position --csv",
    "echo '/husky*/odometry' --field header.stamp --json",
    "echo '/scan/ranges[0:5]' -n 1 --timeout 5s",
    "echo /scan --field header.stamp --field 'ranges[::90]'",
    "echo /chatter --filter \"m.data == 'hello'\"",
    'echo /joint_states --filter "len(position) > 2 and abs(position[0]) < 0.1"',
    "echo -b recorded.log --all --noarr",
)
@argument("words", metavar="TOPIC... [TYPE]", nargs=-1, completer="messages:topics_and_fields")
@option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N messages.")
@flag("-1", "--once", help="Stop after one message.")
@option("--timeout", type=duration, help="Exit with code 4 if no message comes in time.")
@display_options
@flag("-c", "--clear", help="Clear a terminal before each message.")
@flag("-a", "--all", "all_topics", help="All topics of the log (with -b).")
def command(
    words: tuple[str, ...],
    *,
    count: int | None,
    once: bool,
    timeout: float | None,
    clear: bool,
    all_topics: bool,
    **shown: Any,  # noqa: ANN401 - of ``display``
) -> None:
    """Print the messages of topics, as rostopic does.

    TOPIC may end in a field path, or be a pattern: * is any characters but /, ** any. In --filter,
    m is the message. TYPE is needed only if two types have the same fields.
    """
    if shown["offset"] and chosen_logs():
        raise UsageError(
            "--offset is relative to the current time, which a log does not have",
            "leave out --offset",
        )
    topics, type_ = _topics_and_type(words, all_topics=all_topics)
    options = display(type_, **shown)
    prefix = clearing() if clear and options.form in ("text", "flow") else ""
    names = looking_names()
    meant = [select_topics(topic, names) for topic in topics]
    with open_monitor("echo", whole=True, plays=True) as monitor:
        end_with_reader()
        monitor.discover()
        if monitor.tap:
            monitor.tap.longest_nap = _NAP if may_wait() else 0.0
        stream = ArrivalStream(monitor, meant, names)
        for types, path in stream.announced():
            options.check(types, path)
        named, exact = options.message_class, "@" in type_
        decoder = Decoder(monitor.types_of, named, exact=exact, keep_stray=True)
        formatter = MessageFormatter(decoder, options, lambda: stream.is_one_of_many, notify)
        count, most = (1 if once else count), (1 if once or count else TOGETHER)
        if monitor.logs and options.form == "csv":  # its columns are those of all messages
            deque(islice(taken(stream, formatter.learn_columns, timeout), count), maxlen=0)
            monitor.rewind()
            stream = ArrivalStream(monitor, meant, names)
        found = taken_together(stream, formatter.text, timeout, notify, most=most)
        for texts in islice(found, count):
            write_data("\n".join(f"{prefix}{on_screen(text)}" for text in texts))
        if not count:
            notify_damage(monitor)


def _topics_and_type(words: tuple[str, ...], *, all_topics: bool) -> tuple[tuple[str, ...], str]:
    if all_topics and not chosen_logs():
        raise UsageError("--all is for logs", "name one with -b, or echo '**'")
    if all_topics and words:
        raise UsageError("--all shows all topics", "leave out --all, or the topic")
    if not (words or all_topics):
        raise click.MissingParameter(param_hint="'TOPIC'", param_type="argument")
    if len(words) > 1 and (paths := chosen_logs()):
        with Logs(paths) as logs:  # they may have stored the type
            provide_recorded_types(logs.types())
    if len(words) > 1 and means_type(words[-1]):
        return words[:-1], words[-1]
    return words or (_ALL_TOPICS,), ""


def display(
    type_: str,
    *,
    fields: tuple[str, ...],
    condition: str | None,
    noarr: bool,
    nostr: bool,
    longest: int | None,
    full_length: bool,
    offset: bool,
    width: int | None,
    as_csv: bool,
    as_flow: bool,
    raw: bool,
    as_json: bool,
) -> DisplayOptions:
    """Return the display options of the command line, for messages of a type; "" for any type."""
    if full_length and longest is not None:
        raise UsageError("--full-length and --truncate-length exclude each other", "leave one out")
    forms = dict(zip(_FORMS, (as_json, as_csv, as_flow, raw), strict=True))
    is_cut, is_wide = longest is not None, width is not None
    names = ("--noarr", "--nostr", "--truncate-length", "--offset", "-w")
    changes = zip(names, (noarr, nostr, is_cut, offset, is_wide), strict=True)
    form = _form([name for name in forms if forms[name]], [name for name, on in changes if on])
    view = View(noarr, nostr, longest, is_table=as_csv)
    if sys.stdout.isatty() and form in ("text", "flow") and not full_length:
        view = view._replace(most_elements=_SHORT, ellipsis=_MORE)
    return DisplayOptions(
        form,
        tuple(map(parse_path, fields)),
        Filter(condition) if condition is not None else None,
        view=view,
        writer=Writer(width),
        is_relative=offset,
        message_class=message_class(type_, any_version=True) if type_ else None,
    )


def _form(given: list[str], changes: list[str]) -> Form:
    """Choose the output form. ``changes`` are options that only modify how values are shown."""
    if len(given) > 1 and given != ["--json", "--raw"]:
        raise UsageError(f"{' and '.join(given)} exclude each other", f"leave out {given[-1]}")
    if "--raw" in given and changes:
        raise UsageError("--raw shows whole messages", f"leave out {' and '.join(changes)}")
    if "-w" in changes and given and given != ["--flow-style"]:
        raise UsageError(f"-w and {given[0]} exclude each other", f"leave out {given[0]} or -w")
    return "raw json" if len(given) > 1 else _FORMS[given[0]] if given else "text"
