"""``lcmtools param get``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, bus_options, json_option
from lcmtools.cli.output import document, lines
from lcmtools.cli.param.ask import complain_of, look, pick, timeout_option
from lcmtools.cli.param.shown import block, json_value, json_values, pretty, tree
from lcmtools.cli.param.target import Target, find_target
from lcmtools.node.remote import RemoteParameter


@click.command("get", context_settings=CONTEXT)
@click.argument("node", shell_complete=complete("bus:parameters"))
@click.argument("name", default="", shell_complete=complete("bus:parameters"))
@click.option("-p", "--pretty", "is_pretty", is_flag=True, help="Print a text without quotes.")
@click.option("--hide-type", is_flag=True, hidden=True, help="As it is here anyway.")
@timeout_option
@json_option
@bus_options
def command(
    node: str, name: str, *, is_pretty: bool, hide_type: bool, timeout: float, as_json: bool
) -> int:
    """Print the value of a parameter: NODE NAME, or both in one word as rosparam has it.

    Without a name all parameters of the node, or of all nodes in a namespace.

    \b
    Examples:
      lcmtools param get simple_controller kp
      lcmtools param get /husky0/simple_controller/kp
      lcmtools param get /husky0
    """  # noqa: D301 - \b is click's mark
    del hide_type
    asker = look(timeout)
    target = find_target(asker.graph, [node, name] if name else [node])
    if target.is_namespace:
        answers, errors = asker.ask(target.nodes)
        values = {node: json_values(parameters) for node, parameters in answers.items()}
        document(values) if as_json else lines(tree(answers))
        return complain_of(errors)
    found = asker.ask_one(target.node)
    _print(target, found, is_pretty=is_pretty, as_json=as_json)
    return 0


def _print(
    target: Target, found: dict[str, RemoteParameter], *, is_pretty: bool, as_json: bool
) -> None:
    if target.parameter is None:
        document(json_values(found)) if as_json else lines(block(found))
        return
    parameter = pick(found, target.parameter, target.node.name)
    if as_json:
        document(json_value(parameter))
    else:
        lines((pretty(parameter.value()) if is_pretty else parameter.text).split("\n"))
