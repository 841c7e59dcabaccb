"""``lcmtools type``."""

import click

from lcmtools.cli.describe import UNKNOWN, fingerprint_rows, type_text
from lcmtools.cli.find import find_topic
from lcmtools.cli.options import CONTEXT, bus_options, json_option, open_watch
from lcmtools.cli.output import data, document
from lcmtools.errors import LcmtoolsError


@click.command("type", context_settings=CONTEXT)
@click.argument("topic")
@json_option
@bus_options
def command(topic: str, *, as_json: bool) -> None:
    """Print a topic's type.

    \b
    Examples:
      lcmtools type /husky0/odometry
      lcmtools msg show $(lcmtools type /chatter)
    """  # noqa: D301 - \b is click's mark
    with open_watch("type") as watch:
        found = find_topic(watch.settle(), topic)
    text = type_text(found)
    if as_json:
        document({"topic": found.name, "type": None if text == UNKNOWN else text})
    elif text == UNKNOWN:
        raise LcmtoolsError(
            f"the type of {found.name} is not known", "; ".join(fingerprint_rows(found))
        )
    else:
        data(text)
