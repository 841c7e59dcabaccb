"""``lcmtools param get``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import in_names, json_option, looking_options
from lcmtools.cli.output import document, lines
from lcmtools.cli.param.common import (
    block,
    complain_of,
    json_value,
    json_values,
    look,
    timeout_option,
    tree,
)
from lcmtools.publish.parameters import find_target, pick


@subcommand("get")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@option("-p", "--pretty", "is_pretty", is_flag=True, help="Print a text without quotes.")
@option("--hide-type", is_flag=True, hidden=True, help="As it is here anyway.")
@timeout_option
@json_option
@looking_options
def command(
    node: str, name: str, *, is_pretty: bool, hide_type: bool, timeout: float, as_json: bool
) -> int:
    """Print the value of a parameter: NODE NAME, or both in one word as in rosparam.

    Without a name all parameters of the node, or of all nodes in a namespace.

    \b
    Examples:
      lcmtools param get simple_controller kp
      lcmtools param get /husky0/simple_controller/kp
      lcmtools param get /husky0
    """
    del hide_type
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), name] if name else [in_names(node)])
    if target.is_namespace:
        answers, errors = client.get_all(target.nodes)
        values = {node: json_values(parameters) for node, parameters in answers.items()}
        document(values) if as_json else lines(tree(answers))
        return complain_of(errors)
    found = client.get(target.node.name)
    if target.parameter is None:
        document(json_values(found)) if as_json else lines(block(found))
        return 0
    parameter = pick(found, target.parameter, target.node.name)
    value = parameter.value()
    if as_json:
        document(json_value(parameter))
    else:
        lines((value if is_pretty and isinstance(value, str) else parameter.text).split("\n"))
    return 0
