"""``lcmtools bag record``."""

import os
import shutil
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import click

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bag.recorder import BagRecorder, Limits, Progress, open_bus
from lcmtools.bag.recording_words import summary
from lcmtools.bag.ring import SnapshotPlan, Trigger
from lcmtools.bag.series import USUAL_NAME, LogSeries
from lcmtools.bag.services import recorder_node
from lcmtools.cli.bus import chosen_url, looking_names, notify
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
from lcmtools.cli.output import results_beside, write_document, write_note
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.node.node import Node
from lcmtools.node.spinning import spin_once
from lcmtools.observe.reports.describe import size_text
from lcmtools.settings import parse_bytes, parse_duration
from lcmtools.terminal import Terminal, TerminalKeys, is_terminal
from lcmtools.text_table import plural
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


_TURN = 0.1  # [s] between looks at keys and requests
_PAUSE, _SAVE, _END = " ", "s", "q"


def run_recording(recorder: BagRecorder, series: LogSeries, node: Node | None) -> None:
    """Show the progress of a recording, and handle keys and requests, until it ends."""
    with ExitStack() as stack:
        line = stack.enter_context(StatusLine("lcmtools bag record"))
        trouble = recorder.progress().trouble
        keys = None
        if line.shows and is_terminal(sys.stdin):
            keys = TerminalKeys(stack.enter_context(Terminal(keys=True)))
        while not recorder.wait(0.0 if keys or node else _TURN):
            if node is not None:
                spin_once(node, 0.0 if keys else _TURN)
            for key in keys.read(_TURN) if keys else ():
                if key == _END:
                    return
                _press(key, recorder)
            _write_notes(line, recorder.silence())
            progress = recorder.progress()
            if progress.trouble != trouble:
                trouble = progress.trouble
                line.write_note(trouble or "the bus is back")
            if rates := line.rates(progress.messages, progress.bytes):
                line.write(_status(progress, rates, series))
        _write_notes(line, recorder.silence())


def _write_notes(line: StatusLine, sentences: Sequence[str]) -> None:
    for sentence in sentences:
        line.write_note(sentence)


@contextmanager
def recording(recorder: BagRecorder, series: LogSeries, *, as_json: bool) -> Iterator[None]:
    """Record, and report what was recorded in one line at the end, even after an error."""
    try:
        with recorder:
            yield
    except LcmtoolsError as error:
        if recorder.has_ended and not error.hint and series.paths and series.paths[-1].is_file():
            kept = size_text(series.paths[-1].stat().st_size)
            hint = f"{series.paths[-1]} has {kept} of complete messages"
            raise LcmtoolsError(error.what, hint) from error
        raise
    finally:
        if recorder.has_ended and as_json:
            with results_beside(series.paths[-1] if series.paths else None):
                write_document(_record(recorder.progress(), series))
        elif recorder.has_ended and not isinstance(sys.exc_info()[1], LcmtoolsError):
            notify(summary(recorder.progress(), series))


def _record(progress: Progress, series: LogSeries) -> dict[str, object]:
    """Return the summary for JSON."""
    return {
        "files": [*map(str, series.paths)],
        "messages": progress.messages,
        "bytes": progress.bytes,
        "losses": [
            {"sender": name, "lost": loss.lost, "of": loss.sent}
            for name, loss in progress.losses.items()
        ],
        "buffer_overflows": progress.overflows,
    }


def _status(progress: Progress, rates: Sequence[float], series: LogSeries) -> str:
    parts = [
        f"{plural(progress.messages, 'message')}, {rates[0]:.0f}/s",
        f"{size_text(progress.bytes)}, {size_text(rates[1])}/s",
    ]
    if not progress.is_writing:
        kept = f"{plural(progress.kept_messages, 'message')}, {size_text(progress.kept_bytes)}"
        parts = [f"keeping {kept} (s saves)", *([parts[0]] if progress.messages else [])]
    if progress.is_paused:
        parts.insert(0, "paused (space resumes)")
    folder = series.paths[-1].parent if series.paths else Path()
    with suppress(OSError):
        parts.append(f"{size_text(shutil.disk_usage(folder).free)} free")
    lost = sum(loss.lost for loss in progress.losses.values())
    if progress.losses_are_known:
        parts.append(f"{lost} lost" if lost else "none lost")
    return "; ".join(parts)


def _press(key: str, recorder: BagRecorder) -> None:
    if key == _PAUSE:
        recorder.is_paused = not recorder.is_paused
    elif key == _SAVE and recorder.is_of_snapshots:
        recorder.save()
