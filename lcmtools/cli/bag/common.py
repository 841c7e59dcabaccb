"""Options, arguments and results of the commands that write a log from another one."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.summary import LogSummary, summarize
from lcmtools.bag.surgery import write_log
from lcmtools.cli.bus import notify
from lcmtools.cli.declare import CommandT, argument, flag, option, together
from lcmtools.cli.options import json_option, log_time
from lcmtools.cli.output import progress, results_beside, write_result
from lcmtools.errors import UsageError
from lcmtools.observe.reading.log_file import LogFile, lost_bytes_text
from lcmtools.observe.reports.describe import size_text
from lcmtools.text_table import plural
from lcmtools.wire.packet import Packet

places = together(
    argument("source", metavar="IN", completer="files"),
    argument("target", metavar="OUT", completer="files"),
)
force_option = flag("--force", help="Overwrite an existing file.")
made_options = together(force_option, json_option)
stamp_option = flag(
    "--by-stamp", help="Use the times in the messages, instead of those of recording."
)
values_options = together(
    option("--type", "type_", metavar="TYPE", help="The type of the values in a CSV file."),
    option("--as", "topic", metavar="TOPIC", help="The topic of a CSV file, or of JSON lines."),
)
topics_option = option(
    "-t",
    "--topics",
    "wanted",
    metavar="TOPIC",
    multiple=True,
    completer="logs:topics",
    help="Only this topic, namespace or pattern; may be repeated.",
)
exclude_option = option(
    "-x",
    "--exclude",
    "excluded",
    metavar="TOPIC",
    multiple=True,
    completer="logs:topics",
    help="Not this topic, namespace or pattern; may be repeated.",
)


def not_negative(otherwise: str) -> Callable[[str | float], float]:
    """Return a parser of numbers from 0 on, for ``type=``; ``otherwise`` says what they are."""

    def parse(value: str | float) -> float:
        try:
            number = float(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is not a number") from None
        if not 0 <= number < float("inf"):
            raise click.BadParameter(otherwise)
        return number

    return parse


def time_option(*names: str, text: str) -> Callable[[CommandT], CommandT]:
    """Return an option whose value is a time within a log."""
    return option(*names, metavar="TIME", type=log_time, help=text)


window_options = together(
    time_option("-s", "--start", text="Start at this time: 10s, end-1m, 12:30:05."),
    time_option("-e", "--end", text="End at this time."),
)


def summary_of(file: str) -> LogSummary:
    """Return the summary of a log. Show progress if the log must be read."""
    with LogFile(file) as log, progress(f"reading {file}", log.size) as report:
        return summarize(log, report)


def told_summary_of(file: str) -> LogSummary:
    """Return the summary of a log, and write a note if bytes of it belong to no message."""
    summary = summary_of(file)
    if damage := lost_bytes_text(file, summary.damaged):
        notify(damage)
    return summary


def topic_choice(log: LogFile, wanted: tuple[str, ...], excluded: tuple[str, ...]) -> TopicChoice:
    """Return the choice of topics. Raise an error for a topic that is not in the log."""
    choice = TopicChoice(wanted, excluded)
    if wanted or excluded:
        choice.check({name for block in log.blocks() for name in block.channels})
    return choice


def write(
    target: str,
    packets: Iterable[Packet],
    *sources: LogFile,
    force: bool,
    as_json: bool,
    more: Callable[[], Mapping[str, object]] = dict,
    tell_damage: bool = True,
    **change: Any,  # noqa: ANN401 - of write_log
) -> None:
    """Write a log, and print how many messages it has. JSON also has what ``more`` returns then."""
    total = sum(source.size for source in sources)
    with progress(f"writing {target}", total) as report:
        done = write_log(target, packets, sources, force=force, progress=report, **change)
    size = Path(target).stat().st_size if Path(target).is_file() else done.size
    record: Mapping[str, object] = {
        "path": target,
        "messages": done.messages,
        "bytes": size,
        **more(),
    }
    rows = [f"{target}: {plural(done.messages, 'message')}, {size_text(size)}"]
    if tell_damage:
        notify_damage(*sources)
    with results_beside(target):
        write_result(record, rows, as_json=as_json)


def notify_damage(*logs: LogFile) -> None:
    """Write a note for each log with bytes that belong to no message."""
    for log in logs:
        if damage := log.damage(log.blocks()):
            notify(damage)


def refuse_no_files(words: tuple[str, ...], topics: tuple[str, ...]) -> None:
    """Raise UsageError for a file name that is a remap, or another topic for ``-t``."""
    for word in (word for word in words if not Path(word).exists()):
        if ":=" in word:
            what = f"'{word}' is no remap, as its names are no names of ROS"
            raise UsageError(what, "lcmtools bag rename IN OUT OLD:=NEW takes any names")
        if topics and word.startswith("/"):
            raise UsageError(f"there is no file {word}", f"for one more topic, add -t {word}")
