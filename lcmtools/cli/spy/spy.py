"""``lcmtools spy``."""

import shutil
import sys

import click

from lcmtools.cli.bus import in_names, looking_names, notify, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import write_document, write_lines, write_note
from lcmtools.errors import UsageError
from lcmtools.observe.channels import channel_report
from lcmtools.observe.channels.columns import COLUMNS, TableView
from lcmtools.observe.channels.rows import ChannelSelection, plain_listeners, survey
from lcmtools.observe.reports.describe import all_callback_errors

_WAIT = 1.2  # [s] a little more than one period at 1 Hz


@subcommand("spy", all_option, json_option, looking_options)
@examples("spy", "spy --once", "spy --once /husky0 --sort bandwidth", "spy --once --wait 3s --json")
@argument("topics", metavar="[TOPIC]...", nargs=-1, completer="bus:names")
@flag("--once", help="Observe for a moment, print the table, and exit.")
@option("--wait", type=duration, help="With --once: observe for this long (else 1.2 s).")
@option(
    "--sort",
    "column",
    type=click.Choice(list(COLUMNS)),
    metavar="COLUMN",
    default="channel",
    help=f"Sort by this column: {', '.join(COLUMNS)}.",
)
@flag("-r", "--reverse", help="Reverse the order.")
@option(
    "--filter",
    "text",
    default="",
    metavar="TEXT",
    help="Only rows with this text in channel, type, sender or listener.",
)
def command(
    topics: tuple[str, ...],
    *,
    once: bool,
    wait: float | None,
    column: str,
    reverse: bool,
    text: str,
    show_all: bool,
    as_json: bool,
) -> int:
    """Watch the channels of the bus, live: type, rate, jitter, bandwidth, loss, senders, listeners.

    TOPIC selects a channel, the channels in a namespace, or those that match a pattern ('/husky*').
    Enter shows the selected channel's messages, decoded, with plots of their numbers; F1 lists the
    keys. --once prints the table; it and --json do not need textual.

    Jitter is the longest recent interval minus the shortest. Loss is that of a channel's senders,
    because LCM numbers a sender's messages across channels; messages that this computer was too
    busy to receive count as lost. A type with "+2" may be one of two others with the same
    fingerprint. Nodes that publish only for subscribers start publishing.
    """
    selection = ChannelSelection(tuple(map(in_names, topics)), show_all, looking_names().namespace)
    view = TableView(column, reverse, text)
    if not (once or as_json):
        if wait is not None:
            raise UsageError(
                "--wait can only be used with --once", "leave it out for the live view"
            )
        from lcmtools.cli.spy.live import watch

        return watch(selection, view)
    with open_monitor("spy") as monitor:
        graph, found = survey(monitor, selection, _WAIT if wait is None else wait)
        url = monitor.url
    rows = view.rows(found)
    if as_json:
        write_document(list(map(channel_report.to_json, rows)))
        return 0
    if rows:
        room = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        write_lines(channel_report.to_lines(rows, room))
    else:
        where = f" in {', '.join(topics)}" if topics else ""
        write_note(f"no topics{where}{f' with {text!r}' if text else ''} on {url}")
    if any(row.lost for row in rows):
        notify(
            "loss is that of a channel's senders: LCM numbers messages per sender, not per channel"
        )
    for error in all_callback_errors(graph):
        notify(error)
    if programs := plain_listeners(graph, url):
        who = ", ".join(programs)
        notify(f"{who}: also receives, but is not a node; its channels are unknown")
    return 0
