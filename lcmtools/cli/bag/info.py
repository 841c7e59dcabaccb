"""``lcmtools bag info`` and ``reindex``."""

from lcmtools.bag import summary_report
from lcmtools.bag.reindex import reindex_log
from lcmtools.cli.bag.common import summary_of
from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import progress, write_document, write_lines, write_result
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reports.describe import size_text


@subcommand("info", json_option)
@examples("bag info ride.lcmlog", "bag info *.lcmlog --json")
@argument("files", metavar="FILE...", nargs=-1, required=True, completer="files")
def info(files: tuple[str, ...], *, as_json: bool) -> None:
    """Show what is in logs: times, topics with their types, counts, rates, sizes, gaps, losses.

    With an index this takes milliseconds, however large the log is; without one, the whole log is
    read. The activity is the number of messages over the time of the log. The longest gap is the
    longest time without a message on the topic. Losses are messages that did not reach the
    recorder, by their sender's sequence numbers.
    """
    found = list(map(summary_of, files))
    if as_json:
        write_document(list(map(summary_report.to_json, found)))
        return
    for number, summary in enumerate(found):
        write_lines([""] if number else [])
        write_lines(summary_report.to_lines(summary))


@subcommand("reindex", json_option)
@examples("bag reindex old.lcmlog", "bag reindex *.lcmlog --json")
@argument("files", metavar="FILE...", nargs=-1, required=True, completer="files")
def reindex(files: tuple[str, ...], *, as_json: bool) -> None:
    """Write the index of logs that have none, or complete one that was cut off.

    The logs themselves are not changed. What an index already has is kept.
    """
    sizes: dict[str, int] = {}
    for file in files:
        with LogFile(file) as log, progress(f"reading {file}", log.size) as report:
            sizes[file] = reindex_log(log, report)
    records = [{"path": file, "indexed_bytes": size} for file, size in sizes.items()]
    rows = [f"{file}: {size_text(size)} indexed" for file, size in sizes.items()]
    write_result(records, rows, as_json=as_json)
