"""``lcmtools param describe``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import in_names, json_option, looking_options
from lcmtools.cli.output import document, lines
from lcmtools.cli.param.common import look, record, timeout_option
from lcmtools.publish.parameters import RemoteParameter, find_target, pick


@subcommand("describe")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@timeout_option
@json_option
@looking_options
def command(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Show a parameter's type, value, description and range; all parameters without a NAME.

    \b
    Examples:
      lcmtools param describe simple_controller kp
      lcmtools param describe /husky0/simple_controller
    """
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), name] if name else [in_names(node)])
    full = target.node.name
    found = client.get(full)
    wanted = target.parameter
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    if as_json:
        document([record(full, parameter) for parameter in parameters])
    else:
        lines(row for parameter in parameters for row in _rows(full, parameter))


def _rows(node: str, parameter: RemoteParameter) -> list[str]:
    """The lines of ros2 param describe, and the value."""
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
