"""``lcmtools echo``."""

import os
import stat
import sys
from collections.abc import Mapping
from contextlib import suppress
from itertools import islice

import click

from lcmtools.bus.url import BusUrl
from lcmtools.cli.bus import looking_names, notify, open_monitor
from lcmtools.cli.declare import argument, duration, examples, option, subcommand, whole_number
from lcmtools.cli.options import bus_choice, json_option, looking_options
from lcmtools.cli.output import data
from lcmtools.errors import UsageError
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import parse_path
from lcmtools.messages.plain import View
from lcmtools.messages.registry import message_class, packages
from lcmtools.messages.text import Writer
from lcmtools.observe.arrivals import ArrivalStream, taken
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.formatter import DisplayOptions, Form, MessageFormatter
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.selection import select_topics
from lcmtools.observe.sources import LogObserver

_FORMS: dict[str, Form] = {"--json": "json", "--csv": "csv", "--flow-style": "flow", "--raw": "raw"}
_NAP = 0.01  # [s] that messages may wait for each other on their way to a screen
_ALL_TOPICS = "**"
_SHORT = 200  # elements of an array on a terminal
_MORE = "... {} more, which --full-length shows"
_CLEAR = "\033[2J\033[;H"  # the screen, and the cursor to its corner


@subcommand("echo", json_option, looking_options)
@examples(
    "echo /husky0/odometry",
    "echo /husky0/odometry/pose.pose.position --csv",
    "echo '/husky*/odometry' --field header.stamp --json",
    "echo /scan/ranges[0:5] -n 1 --timeout 5s",
    "echo /scan --field header.stamp --field ranges[::90]",
    "echo /chatter --filter \"m.data == 'hello'\"",
    'echo /joint_states --filter "len(position) > 2 and abs(position[0]) < 0.1"',
    "echo -b recorded.log --all --noarr",
)
@argument("words", metavar="TOPIC... [TYPE]", nargs=-1, completer="messages:topics_and_fields")
@option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N messages.")
@option("-1", "--once", is_flag=True, help="Stop after one message.")
@option("--timeout", type=duration, help="Exit with code 4 when none comes in time.")
@option(
    "--field",
    "fields",
    metavar="PATH",
    multiple=True,
    help="Show this field; may be repeated.",
    completer="messages:fields",
)
@option("--filter", "condition", metavar="EXPR", help="Only messages for which this is true.")
@option("--noarr", "--no-arr", is_flag=True, help="Show only the type and length of arrays.")
@option("--nostr", "--no-str", is_flag=True, help="Show only the length of strings.")
@option(
    "-l",
    "--truncate-length",
    "longest",
    metavar="N",
    type=whole_number(1),
    help="Truncate arrays and strings to N elements.",
)
@option("-f", "--full-length", is_flag=True, help="Show long arrays in full on a terminal, too.")
@option("--offset", is_flag=True, help="Show times relative to the message's arrival.")
@option("-w", "width", metavar="N", type=whole_number(2), help="Print numbers with width N.")
@option("-p", "--csv", "as_csv", is_flag=True, help="Print comma-separated values.")
@option("--flow-style", "as_flow", is_flag=True, help="Print each message on one line.")
@option("--raw", is_flag=True, help="Print the payload in hexadecimal.")
@option("-c", "--clear", is_flag=True, help="Clear a terminal before each message.")
@option(
    "-b", "--bag", metavar="FILE", help="Read an LCM log instead of the bus.", completer="files"
)
@option("-a", "--all", "all_topics", is_flag=True, help="All topics of the log (with -b).")
def command(
    words: tuple[str, ...],
    *,
    count: int | None,
    once: bool,
    timeout: float | None,
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
    clear: bool,
    bag: str | None,
    all_topics: bool,
    as_json: bool,
) -> None:
    """Print the messages of topics, as rostopic does.

    TOPIC may end in a field path: dots or slashes, [0] or [0:5] for arrays. In quotes it may be a
    pattern: * is any characters but /, ** any characters, ? one; topics that appear later are
    included. With several topics each message is labelled with its own: by a line such as #
    /chatter, by "topic" beside "message" in --json, by a column in --csv. TYPE is needed only if
    two types have the same fields.

    In --filter, m is the message. Available are comparisons, arithmetic, and, or, not, in, and
    functions such as len and hypot. A message of an unknown type is shown in hexadecimal. Times in
    --csv are nanoseconds; %time is the header's stamp, else the time of arrival. Text that is not
    UTF-8 is !!binary in YAML and has \\udcXX for a byte in --json; pub accepts both without loss.
    """
    forms = {"--json": as_json, "--csv": as_csv, "--flow-style": as_flow, "--raw": raw}
    changes = {
        "--noarr": noarr,
        "--nostr": nostr,
        "--truncate-length": longest is not None,
        "--offset": offset,
        "-w": width is not None,
    }
    if full_length and longest is not None:
        raise UsageError("--full-length and --truncate-length exclude each other", "leave one out")
    if offset and bag is not None:
        raise UsageError("--offset is relative to now, and a log has no now", "leave out --offset")
    topics, type_ = _topics_and_type(words, bag, all_topics=all_topics)
    form = _form(forms, changes)
    is_short = sys.stdout.isatty() and form in ("text", "flow") and not full_length
    options = DisplayOptions(
        form,
        tuple(map(parse_path, fields)),
        Filter(condition) if condition is not None else None,
        view=View(noarr, nostr, longest, _SHORT if is_short else None, _MORE, is_table=as_csv),
        writer=Writer(width),
        is_relative=offset,
        message_class=message_class(type_) if type_ else None,
    )
    prefix = _CLEAR if clear and not (as_json or as_csv or raw) and _can_clear() else ""
    limit = 1 if once else count
    names = looking_names()
    meant = [select_topics(topic, names) for topic in topics]
    with _open(bag) as monitor:
        monitor.discover()
        if monitor.tap:
            monitor.tap.longest_nap = _NAP if _may_wait() else 0.0
        stream = ArrivalStream(monitor, meant, names)
        for types, path in stream.announced():
            options.check(types, path)
        decoder = Decoder(monitor.types_of, options.message_class, keep_stray=True)
        formatter = MessageFormatter(decoder, options, lambda: stream.is_one_of_many, notify)
        for text in islice(taken(stream, formatter.text, timeout, notify), limit):
            data(f"{prefix}{text}")


def _form(forms: Mapping[str, bool], changing: Mapping[str, bool]) -> Form:
    """The form that flags mean, beside those that change how values are shown."""
    given = [flag for flag, is_given in forms.items() if is_given]
    if len(given) > 1 and given != ["--json", "--raw"]:
        raise UsageError(f"{' and '.join(given)} exclude each other", f"leave out {given[-1]}")
    changes = [flag for flag, is_given in changing.items() if is_given]
    if "--raw" in given and changes:
        raise UsageError("--raw shows whole messages", f"leave out {' and '.join(changes)}")
    if "-w" in changes and given and given != ["--flow-style"]:
        raise UsageError(f"-w and {given[0]} exclude each other", f"leave out {given[0]} or -w")
    return "raw json" if len(given) > 1 else _FORMS[given[0]] if given else "text"


def _topics_and_type(
    words: tuple[str, ...], bag: str | None, *, all_topics: bool
) -> tuple[tuple[str, ...], str]:
    if all_topics and bag is None:
        raise UsageError("--all is for logs", "name one with -b, or echo '**'")
    if all_topics and words:
        raise UsageError("--all shows all topics", "leave out --all, or the topic")
    if not (words or all_topics):
        raise click.MissingParameter(param_hint="'TOPIC'", param_type="argument")
    if len(words) > 1 and words[-1].partition("/")[0] in packages():
        return words[:-1], words[-1]
    return words or (_ALL_TOPICS,), ""


def _open(bag: str | None) -> BusMonitor:
    if bag is None:
        return open_monitor("echo", whole=True, plays=True)
    if bus_choice().url or bus_choice().domain:
        raise UsageError("-b reads a log in place of the bus", "leave out --lcm-url and --domain")
    return BusMonitor(BusUrl("file", bag), "echo", os.environ, LogObserver(bag))


def _may_wait() -> bool:
    """Return True where a person or a file takes the output: a program at a pipe must not wait."""
    with suppress(OSError):  # it is no file of the system
        mode = os.fstat(sys.stdout.fileno()).st_mode
        return stat.S_ISREG(mode) or stat.S_ISCHR(mode)
    return False


def _can_clear() -> bool:
    return sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb"
