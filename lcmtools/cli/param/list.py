"""``lcmtools param list``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import all_option, in_names, json_option, looking_options
from lcmtools.cli.output import document, lines, talk
from lcmtools.cli.param.common import complain_of, living_nodes, look, record, timeout_option
from lcmtools.publish.parameters import find_target


@subcommand("list")
@argument("node", default="", completer="bus:nodes")
@option("-t", "--show-types", is_flag=True, help="Show each parameter's type.")
@option("-v", "--values", "show_values", is_flag=True, help="Show each parameter's value.")
@timeout_option
@all_option
@json_option
@looking_options
def command(
    node: str, *, show_types: bool, show_values: bool, timeout: float, show_all: bool, as_json: bool
) -> int:
    """List the parameters of the nodes on the bus, by their full names.

    NODE may be a namespace too. Exits with 4 when a node does not answer.

    \b
    Examples:
      lcmtools param list
      lcmtools param list simple_controller -v
    """
    graph, client = look(timeout)
    if node:
        nodes = list(find_target(graph, [in_names(node)]).nodes)
    else:
        nodes = living_nodes(graph, show_all=show_all)
    answers, errors = client.get_all(nodes)
    found = [(name, p) for name, parameters in answers.items() for p in parameters.values()]
    if as_json:
        document([record(name, parameter) for name, parameter in found])
    else:
        lines(
            f"{name}/{p.name}"
            + (f" [{p.kind}]" if show_types else "")
            + (f": {p.text}" if show_values else "")
            for name, p in found
        )
    if not nodes:
        talk(f"no node with parameters on {client.url}")
    return complain_of(errors)
