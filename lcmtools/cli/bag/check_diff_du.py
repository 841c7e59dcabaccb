"""``lcmtools bag check``, ``diff`` and ``du``."""

from lcmtools.bag.compare import differences
from lcmtools.bag.contract import breaches, read_contract
from lcmtools.cli.bag.common import notify_damage, told_summary_of
from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_document, write_lines, write_result
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reports.describe import size_text
from lcmtools.text_table import text_table


@subcommand("check", json_option)
@examples(
    "bag check ride.lcmlog --against contract.yaml",
    "bag check ride.lcmlog --against contract.yaml --json",
)
@argument("file", metavar="FILE", completer="files")
@option("--against", metavar="CONTRACT", required=True, completer="files", help="A YAML file.")
def check(file: str, *, against: str, as_json: bool) -> int:
    """Check a log against a contract of topics, types, rates and gaps.

    The exit code is 1 if the log breaks it. The contract's keys are topics, others, max_lost,
    min_duration and max_duration; those of a topic are type, min_rate, max_rate [Hz], max_gap [s]
    and min_messages.
    """
    contract = read_contract(against)
    found = list(breaches(contract, told_summary_of(file)))
    place = [f" ({against}:{one.line})" if one.line else "" for one in found]
    rows = [
        f"FAIL {one.topic + ': ' if one.topic else ''}{one.text}{where}"
        for one, where in zip(found, place, strict=True)
    ]
    write_result(
        [one.to_json() for one in found], rows or [f"{file} meets {against}"], as_json=as_json
    )
    return 1 if found else 0


@subcommand("diff", json_option)
@examples("bag diff a.lcmlog b.lcmlog", "bag diff a.lcmlog b.lcmlog --ignore-times")
@argument("first", metavar="FIRST", completer="files")
@argument("second", metavar="SECOND", completer="files")
@flag("--ignore-times", help="Compare only the messages, not their recorded times.")
def diff(first: str, second: str, *, ignore_times: bool, as_json: bool) -> int:
    """Compare two logs topic by topic; the exit code is 1 if they differ.

    Messages are equal if they have the same time and the same bytes.
    """
    with LogFile(first) as one, LogFile(second) as other:
        found = [d for d in differences(one, other, times=not ignore_times) if not d.is_equal]
        notify_damage(one, other)
    names = ("topic", "first", "second", "only_first", "only_second")
    records = [{name: getattr(one, name) for name in names} for one in found]
    write_result(records, map(str, found), as_json=as_json)
    return 1 if found else 0


@subcommand("du", json_option)
@examples("bag du ride.lcmlog", "bag du ride.lcmlog --json")
@argument("file", metavar="FILE", completer="files")
def du(file: str, *, as_json: bool) -> None:
    """Show the topics that take the most space in a log, largest first."""
    summary = told_summary_of(file)
    topics = sorted(summary.topics, key=lambda topic: (-topic.bytes, topic.name))
    if as_json:
        write_document([{"topic": one.name, "bytes": one.bytes} for one in topics])
        return
    rows = [
        (size_text(one.bytes), f"{100 * one.bytes / max(1, summary.bytes):.1f} %", one.name)
        for one in topics
    ]
    write_lines(text_table(rows))
