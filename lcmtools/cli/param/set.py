"""``lcmtools param set``."""

from collections.abc import Mapping

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import in_names, looking_options
from lcmtools.cli.output import talk
from lcmtools.cli.param.common import look, timeout_option
from lcmtools.cli.words import CommandWithWords
from lcmtools.errors import UsageError
from lcmtools.messages.setting import ANY, text_of
from lcmtools.messages.yaml_input import parse_values
from lcmtools.publish.parameters import ParameterClient, Target, find_target

_EXAMPLE = "for example: lcmtools param set /husky0/simple_controller kp 0.5"


@subcommand("set", cls=CommandWithWords)
@argument("words", metavar="NODE NAME VALUE", nargs=-1, completer="bus:parameters")
@timeout_option
@looking_options
def command(words: tuple[str, ...], *, timeout: float) -> None:
    """Change a parameter of a node that runs: NODE NAME VALUE, or /node/name VALUE.

    VALUE is YAML, and of the type that the parameter has. Several parameters of a node change
    together, or none does, when VALUE is a dict. If the node refuses, the exit code is 1.

    \b
    Examples:
      lcmtools param set simple_controller kp 0.5
      lcmtools param set /husky0/simple_controller/kp 0.5
      lcmtools param set simple_controller "{kp: 0.5, ki: 3.3}"
    """
    if len(words) not in (2, 3):
        problem = "the value is missing" if len(words) < 2 else "there are more words than a value"  # noqa: PLR2004
        hint = _EXAMPLE if len(words) < 2 else "put the value in quotes"  # noqa: PLR2004 - name and value
        raise UsageError(problem, hint)
    graph, client = look(timeout)
    target = find_target(graph, [in_names(words[0]), *words[1:-1]])
    texts = _texts(client, target, words[-1])
    parameters = client.set(target.node.name, texts)
    for name in texts:
        talk(f"{target.node.name}/{name} is now {parameters[name].text}")


def _texts(client: ParameterClient, target: Target, value: str) -> Mapping[str, str]:
    """The new values by name: one, or those in a dict."""
    if target.parameter is not None:
        return {target.parameter: value}
    values = parse_values([value])
    if not isinstance(values, dict):
        raise UsageError(
            f"the parameter's name or its value is missing, for {target.node.name}", _EXAMPLE
        )
    known = client.get(target.node.name)
    kinds = {name: known[name].kind if name in known else ANY for name in values}
    return {name: text_of(part, kinds[name]) for name, part in values.items()}
