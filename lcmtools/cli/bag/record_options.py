"""The options of bag record."""

import click

from lcmtools.bag.recorder import Limits
from lcmtools.bag.series import USUAL_NAME
from lcmtools.cli.declare import duration, flag, option, size, together, whole_number
from lcmtools.cli.options import exclude_option
from lcmtools.errors import UsageError
from lcmtools.settings import parse_bytes, parse_duration
from lcmtools.wire.log_compression import SUFFIXES

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


def check_options(
    *, snapshot: float | None, after: float | None, when: str | None, split: str | None
) -> None:
    """Refuse options that exclude each other."""
    if snapshot is None and (after is not None or when is not None):
        raise UsageError("--after and --when are for snapshots", "add --snapshot 30s")
    if snapshot is not None and split is not None:
        raise UsageError("--snapshot writes each snapshot to its own file", "leave out --split")


def split_limits(text: str | None) -> Limits:
    """Return the bounds of a file, as --split has them."""
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
