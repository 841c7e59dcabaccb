"""``lcmtools lab list``."""

from lcmtools.cli.declare import subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import document, lines
from lcmtools.labs.catalogue import LABS, Lab


@subcommand("list")
@json_option
def command(*, as_json: bool) -> None:
    """List the labs.

    \b
    Examples:
      lcmtools lab list
      lcmtools lab list --json
    """
    if as_json:
        document([_plain(lab) for lab in LABS.values()])
        return
    width = max(map(len, LABS))
    lines(f"{lab.name:{width}}  {lab.title}" for lab in LABS.values())


def _plain(lab: Lab) -> dict[str, object]:
    programs = {role.option: " ".join((*role.answer, *role.arguments)) for role in lab.roles}
    plain = {"name": lab.name, "title": lab.title, "world": lab.world}
    return {**plain, "programs": programs, "steps": [*lab.steps]}
