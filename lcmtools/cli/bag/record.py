"""``lcmtools bag record``."""

import os
import signal
from contextlib import ExitStack
from dataclasses import replace

import click

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import BagRecorder, Limits, open_bus
from lcmtools.bag.ring import SnapshotPlan, Trigger
from lcmtools.bag.series import USUAL_NAME, LogSeries
from lcmtools.bag.services import recorder_node
from lcmtools.cli.bag.recording import recording, run_recording
from lcmtools.cli.bus import chosen_url, looking_names
from lcmtools.cli.declare import (
    argument,
    duration,
    examples,
    flag,
    option,
    size,
    subcommand,
    together,
    whole_number,
)
from lcmtools.cli.options import bus_options, exclude_option, json_option, names_options
from lcmtools.cli.output import write_note
from lcmtools.errors import UsageError
from lcmtools.settings import parse_bytes, parse_duration
from lcmtools.wire.log_compression import SUFFIXES, Compression

choice_options = together(
    flag("-a", "--all", "hidden", help="Record hidden topics too."),
    exclude_option,
    option(
        "--node",
        "nodes",
        metavar="NAME",
        multiple=True,
        help="Record the topics of a node.",
        completer="bus:nodes",
    ),
)
"""The topics."""

file_options = together(
    option(
        "-o",
        "-O",
        "--output",
        metavar="FILE",
        default=USUAL_NAME,
        help="The log; %H is the hour, and so on.",
        completer="files",
    ),
    flag("-f", "--force", help="Overwrite existing files."),
    option(
        "--compress",
        "compression",
        type=click.Choice(list(SUFFIXES)),
        help="Compress the log (extra 'bag').",
    ),
    option("--split", metavar="SIZE|TIME", help="Start a new file at this size or time."),
    option(
        "--max-files",
        "--max-splits",
        metavar="N",
        type=whole_number(1),
        help="Keep the last N files.",
    ),
)
"""The files."""

end_options = together(
    option("--duration", "seconds", metavar="TIME", type=duration, help="Stop after this time."),
    option(
        "-n",
        "-l",
        "--limit",
        metavar="N",
        type=whole_number(1),
        help="Record N messages of each topic.",
    ),
    option("--max-size", metavar="SIZE", type=size, help="Stop at this size."),
    flag("--paused", help="Start paused."),
    option("--services", metavar="NAME", help="Offer services NAME/start, NAME/stop, NAME/save."),
)
"""The beginning and the end."""

snapshot_options = together(
    option("--snapshot", metavar="TIME", type=duration, help="Keep the last messages in memory."),
    option("--after", metavar="TIME", type=duration, help="Continue a snapshot for this long."),
    option("--when", metavar="'TOPIC EXPR'", help="Save a snapshot when a message meets this."),
)
"""Snapshots."""


@subcommand(
    "record",
    choice_options,
    file_options,
    end_options,
    snapshot_options,
    names_options,
    bus_options,
    json_option,
)
@examples(
    "bag record",
    "bag record /husky0/odometry '/husky0/cmd_*' -o drive.lcmlog",
    "bag record -a --exclude '**/image' --split 1GB --max-files 10",
    "bag record --snapshot 30s --after 10s --when '/estop m.data'",
)
@argument("topics", metavar="[TOPIC]...", nargs=-1, completer="bus:topics")
def command(
    topics: tuple[str, ...],
    *,
    hidden: bool,
    exclude: tuple[str, ...],
    nodes: tuple[str, ...],
    output: str,
    force: bool,
    compression: Compression | None,
    split: str | None,
    max_files: int | None,
    seconds: float | None,
    limit: int | None,
    max_size: int | None,
    paused: bool,
    services: str | None,
    snapshot: float | None,
    after: float | None,
    when: str | None,
    as_json: bool,
) -> None:
    """Record messages into an LCM log, until Ctrl-C.

    Without topics, all topics except hidden ones are recorded; TOPIC may be a pattern in quotes.
    Messages of plain LCM programs are recorded like those of nodes. lcm-logplayer and all other
    programs for LCM logs can read the log; an index beside it holds types, senders, nodes and
    losses.

    In a terminal the space bar pauses and resumes, s saves a snapshot, and q ends. With --services
    other programs do the same by NAME/start, NAME/stop and NAME/save, of type std_srvs/Trigger.
    With --split the files are name_0, name_1 and so on; each begins with the latched messages.
    --max-size limits what --snapshot keeps; each snapshot is written to its own file.
    """
    check_options(snapshot=snapshot, after=after, when=when, split=split)
    limits = replace(
        split_limits(split), duration=seconds, messages=limit, bytes=None if snapshot else max_size
    )
    names, url = looking_names(), chosen_url()
    choice = RecordedTopics(topics, names, exclude=exclude, nodes=nodes, hidden=hidden)
    series = LogSeries(
        output, numbered=split is not None, most=max_files, force=force, compression=compression
    )
    with ExitStack() as stack:
        monitor = stack.enter_context(
            open_bus(url, os.environ, _note, lambda: signal.raise_signal(signal.SIGTERM))
        )
        trigger = Trigger(when, names, monitor.types_of) if when else None
        kept = SnapshotPlan(snapshot, after or 0.0, max_size, trigger) if snapshot else None
        recorder = BagRecorder(monitor, choice, series, limits, kept, paused=paused)
        stack.enter_context(recording(recorder, series, as_json=as_json))
        node = None
        if services:
            node = stack.enter_context(recorder_node(names.resolve(services), url, recorder))
        run_recording(recorder, series, node)


def _note(text: str) -> None:
    """Write a note; on the recorder's thread there is no running command."""
    write_note(f"lcmtools bag record: {text}")


def check_options(
    *, snapshot: float | None, after: float | None, when: str | None, split: str | None
) -> None:
    """Raise UsageError for options that exclude each other."""
    if snapshot is None and (after is not None or when is not None):
        raise UsageError("--after and --when are for snapshots", "add --snapshot 30s")
    if snapshot is not None and split is not None:
        raise UsageError("--snapshot writes each snapshot to its own file", "leave out --split")


def split_limits(text: str | None) -> Limits:
    """Return the limits of a file, from the value of --split."""
    if text is None:
        return Limits()
    try:
        if seconds := parse_duration(text):
            return Limits(split_time=seconds)
    except UsageError:
        pass
    try:
        return Limits(split_bytes=parse_bytes(text))
    except UsageError:
        what = f"'{text}' is neither a size nor a time; write 1GB or 10m"
        raise click.BadParameter(what, param_hint="'--split'") from None
