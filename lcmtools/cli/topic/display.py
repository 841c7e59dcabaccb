"""The options of a command that prints messages: their form, and the parts that are shown."""

import sys

from lcmtools.cli.declare import flag, option, together, whole_number
from lcmtools.errors import UsageError
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import parse_path
from lcmtools.messages.plain import View
from lcmtools.messages.registry import message_class
from lcmtools.messages.text import Writer
from lcmtools.observe.formatter import DisplayOptions, Form

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
    """Return what ``display_options`` and --json mean, for messages of a type; "" for any."""
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
        message_class=message_class(type_) if type_ else None,
    )


def _form(given: list[str], changes: list[str]) -> Form:
    """The form that options mean, beside those that change how values are shown."""
    if len(given) > 1 and given != ["--json", "--raw"]:
        raise UsageError(f"{' and '.join(given)} exclude each other", f"leave out {given[-1]}")
    if "--raw" in given and changes:
        raise UsageError("--raw shows whole messages", f"leave out {' and '.join(changes)}")
    if "-w" in changes and given and given != ["--flow-style"]:
        raise UsageError(f"-w and {given[0]} exclude each other", f"leave out {given[0]} or -w")
    return "raw json" if len(given) > 1 else _FORMS[given[0]] if given else "text"
