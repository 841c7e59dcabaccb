"""``lcmtools param list``, ``get`` and ``describe``."""

from lcmtools.cli.declare import accepted_for_ros, argument, examples, flag, subcommand
from lcmtools.cli.options import all_option, asking_options, json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.cli.param.common import complain_of, living_nodes, look, named, timeout_option
from lcmtools.publish import parameter_report as report
from lcmtools.publish.remote_parameters import pick, value_of


@subcommand("list", timeout_option, all_option, json_option, asking_options)
@examples("param list", "param list simple_controller -v")
@argument("node", default="", completer="bus:nodes")
@flag("-t", "--show-types", help="Show each parameter's type.")
@flag("-v", "--values", "show_values", help="Show each parameter's value.")
def list_parameters(
    node: str, *, show_types: bool, show_values: bool, timeout: float, show_all: bool, as_json: bool
) -> int:
    """List the parameters of the nodes on the bus, by their full names.

    NODE may be a namespace too. The exit code is 4 if a node does not answer.
    """
    graph, client = look(timeout)
    nodes = named(graph, node).nodes if node else living_nodes(graph, show_all=show_all)
    answers, errors = client.get_all(nodes)
    found = [(name, p) for name, parameters in answers.items() for p in parameters.values()]
    rows = (
        f"{name}/{p.name}{f' [{p.type}]' * show_types}{f': {p.value}' * show_values}"
        for name, p in found
    )
    write_result([report.record(*one) for one in found], rows, as_json=as_json)
    if not nodes:
        write_note(f"no node with parameters on {client.url}")
    return complain_of(errors)


@subcommand("get", timeout_option, json_option, asking_options)
@examples(
    "param get simple_controller kp", "param get /husky0/simple_controller/kp", "param get /husky0"
)
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@flag("-p", "--pretty", "is_pretty", help="Print strings without quotes.")
@accepted_for_ros("--hide-type")  # the type is never shown
def get(node: str, name: str, *, is_pretty: bool, timeout: float, as_json: bool) -> int:
    """Print a parameter: NODE NAME, or /node/name as in rosparam.

    Without a name: all parameters of the node, or of all nodes in a namespace.
    """
    graph, client = look(timeout)
    target = named(graph, node, name)
    if target.is_namespace:
        answers, errors = client.get_all(target.nodes)
        write_result(report.all_values(answers), report.tree(answers), as_json=as_json)
        return complain_of(errors)
    found = client.request(target.node.name)
    if target.parameter is None:
        write_result(report.values(found), report.block(found), as_json=as_json)
        return 0
    parameter = pick(found, target.parameter, target.node.name)
    value = value_of(parameter)
    text = value if is_pretty and isinstance(value, str) else parameter.value
    write_result(value, text.split("\n"), as_json=as_json)
    return 0


@subcommand("describe", timeout_option, json_option, asking_options)
@examples("param describe simple_controller kp", "param describe /husky0/simple_controller")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
def describe(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Show a parameter's type, value, description and range; all parameters without a NAME."""
    graph, client = look(timeout)
    target = named(graph, node, name)
    full, wanted = target.node.name, target.parameter
    found = client.request(full)
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    rows = (row for parameter in parameters for row in report.rows(full, parameter))
    write_result(
        [report.record(full, parameter) for parameter in parameters], rows, as_json=as_json
    )
