"""``lcmtools bag merge``, ``sort`` and ``fix``."""

from contextlib import ExitStack

from lcmtools.bag import edits
from lcmtools.bag.repair import damage_rows, find_damage
from lcmtools.bag.stamps import StampedLog
from lcmtools.cli.bag.common import made_options, places, stamp_option, write
from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.cli.output import write_lines, write_note
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
        more = {"left_out": [part.record() for part in damage]}
        manner = {"force": force, "as_json": as_json, "tell_damage": False}  # told below
        write(target, log.packets(), log, more=lambda: more, **manner)
    write_lines([] if as_json else damage_rows(damage))
    if not damage:
        write_note("nothing is damaged")
    return 1 if damage else 0
