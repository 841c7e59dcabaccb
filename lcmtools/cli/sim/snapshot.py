"""``lcmtools sim snapshot``."""

from pathlib import Path

import click

from lcmtools.cli.declare import argument, examples, flag, option, subcommand, whole_number
from lcmtools.cli.output import write_note
from lcmtools.cli.sim.common import call, sim_options
from lcmtools.errors import UsageError
from lcmtools.folders import write_whole
from lcmtools.types.sim_msgs import Snapshot


@subcommand("snapshot", sim_options)
@examples("sim snapshot world.png", "sim snapshot --robot husky0 --force husky.png")
@argument("file", type=click.Path())
@option(
    "--robot",
    metavar="ROBOT",
    default="",
    help="View from behind this robot, not from above.",
    completer="bus:robots",
)
@option("--width", type=whole_number(1), metavar="N", default=800, help="Pixels (else 800).")
@option("--height", type=whole_number(1), metavar="N", default=600, help="Pixels (else 600).")
@flag("--force", help="Overwrite an existing file.")
def command(
    file: str, *, robot: str, width: int, height: int, force: bool, name: str | None, timeout: float
) -> None:
    """Write an image of the world to a PNG FILE ('-': standard output)."""
    path = Path(file)
    if path.is_file() and not force:
        raise UsageError(f"{file} already exists", "--force overwrites it")
    size = {"width": width, "height": height}
    response = call("snapshot", Snapshot, name, timeout, robot=robot, **size)
    picture = bytes(response.image.data)
    write_whole(path, picture)
    write_note(f"wrote {file}: {len(picture)} bytes")
