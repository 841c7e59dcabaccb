"""``lcmtools bag rename`` and ``shift``: the same messages, elsewhere."""

from lcmtools.bag import edits
from lcmtools.bag.summary import known_nodes, log_span
from lcmtools.bag.times import LogTime
from lcmtools.cli.bag.common import made_options, places, time_option, write
from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.errors import UsageError
from lcmtools.observe.reading.log_file import LogFile


@subcommand("rename", made_options)
@examples("bag rename a.lcmlog b.lcmlog /odom:=/husky0/odometry", "bag rename a b /a/:=/b/")
@places
@argument("names", metavar="OLD:=NEW...", nargs=-1, required=True)
def rename(source: str, target: str, names: tuple[str, ...], *, force: bool, as_json: bool) -> None:
    """Rename topics; with a / at the end of both names, all topics of a namespace."""
    with LogFile(source) as log:
        nodes = known_nodes(log)
        known = dict.fromkeys(name for block in log.blocks(nodes.add) for name in block.channels)
        announced = [topic.name for topic in nodes.snapshot(0).topics()]
        table = edits.parse_renames(names, known, announced)
        found = edits.renamed(log.packets(), table)
        write(
            target,
            found,
            log,
            force=force,
            as_json=as_json,
            change_node=lambda node: edits.renamed_node(node, table),
        )


@subcommand("shift", made_options)
@examples("bag shift a.lcmlog b.lcmlog --by -1.5s", "bag shift a b --to '2026-11-22 12:00:00'")
@places
@option("--by", metavar="TIME", help="Shift by this much; negative is earlier.")
@time_option("--to", text="Make the log start at this time.")
def shift(
    source: str, target: str, *, by: str | None, to: LogTime | None, force: bool, as_json: bool
) -> None:
    """Change the recorded times of all messages; stamps in the messages stay the same."""
    if (by is None) == (to is None):
        raise UsageError("exactly one of --by and --to is needed", "for example --by -1.5s")
    with LogFile(source) as log:
        span = log_span(log)
        late = to.within(*span) - span[0] if to else edits.parse_shift(str(by))
        found = edits.shifted(log.packets(), late)
        write(target, found, log, force=force, as_json=as_json, later=late)
