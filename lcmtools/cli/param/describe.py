"""``lcmtools param describe``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, bus_options, json_option
from lcmtools.cli.output import document, lines
from lcmtools.cli.param.ask import look, pick, timeout_option
from lcmtools.cli.param.shown import record
from lcmtools.cli.param.target import find_target
from lcmtools.node.remote import RemoteParameter


@click.command("describe", context_settings=CONTEXT)
@click.argument("node", shell_complete=complete("bus:parameters"))
@click.argument("name", default="", shell_complete=complete("bus:parameters"))
@timeout_option
@json_option
@bus_options
def command(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Say what a parameter is for: type, value, description and range; all without a NAME.

    \b
    Examples:
      lcmtools param describe simple_controller kp
      lcmtools param describe /husky0/simple_controller
    """  # noqa: D301 - \b is click's mark
    asker = look(timeout)
    target = find_target(asker.graph, [node, name] if name else [node])
    full = target.node.name
    found = asker.ask_one(target.node)
    wanted = target.parameter
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    if as_json:
        document([record(full, parameter) for parameter in parameters])
    else:
        lines(row for parameter in parameters for row in _rows(full, parameter))


def _rows(node: str, parameter: RemoteParameter) -> list[str]:
    """As ros2 param describe has it, with the value."""
    rows = [
        f"Parameter: {node}/{parameter.name}",
        f"  Type: {parameter.kind}",
        f"  Value: {parameter.text}",
    ]
    if parameter.description:
        rows.append(f"  Description: {parameter.description}")
    if parameter.minimum or parameter.maximum:
        low, high = parameter.minimum or "-.inf", parameter.maximum or ".inf"
        rows.append(f"  Range: {low} to {high}")
    if parameter.read_only:
        rows.append("  Read only: it is set when the node starts")
    return rows
