"""``lcmtools lab list``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines
from lcmtools.labs.catalogue import LABS, Lab


@click.command("list", context_settings=CONTEXT)
@json_option
def command(*, as_json: bool) -> None:
    """List the labs.

    \b
    Examples:
      lcmtools lab list
      lcmtools lab list --json
    """  # noqa: D301 - \b is click's mark
    if as_json:
        document([_plain(lab) for lab in LABS.values()])
        return
    width = max(map(len, LABS))
    lines(f"{lab.name:{width}}  {lab.title}" for lab in LABS.values())


def _plain(lab: Lab) -> dict[str, object]:
    programs = {role.option: " ".join((*role.answer, *role.arguments)) for role in lab.roles}
    plain = {"name": lab.name, "title": lab.title, "world": lab.world}
    return {**plain, "programs": programs, "steps": [*lab.steps]}
