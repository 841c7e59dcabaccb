"""``lcmtools param set``."""

from collections.abc import Iterator, Mapping

from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.negative_numbers import CommandWithWords
from lcmtools.cli.options import asking_options
from lcmtools.cli.output import write_note
from lcmtools.cli.param.common import look, named, timeout_option
from lcmtools.errors import UsageError
from lcmtools.messages.documents import parse_values
from lcmtools.messages.fill import Value
from lcmtools.messages.setting import ANY, text_of
from lcmtools.publish.parameter_file import known_name
from lcmtools.publish.remote_parameters import ParameterClient, ParameterTarget

_EXAMPLE = "for example: lcmtools param set /husky0/simple_controller kp 0.5"


@subcommand("set", timeout_option, asking_options, cls=CommandWithWords)
@examples(
    "param set simple_controller kp 0.5",
    "param set /husky0/simple_controller/kp 0.5",
    'param set simple_controller "{kp: 0.5, ki: 3.3}"',
)
@argument("words", metavar="NODE NAME VALUE", nargs=-1, completer="bus:parameters")
def set_parameters(words: tuple[str, ...], *, timeout: float) -> None:
    """Set a parameter of a running node: NODE NAME VALUE, or /node/name VALUE.

    VALUE is YAML, of the parameter's type. A dict sets several parameters of a node, all or none.
    The exit code is 1 if the node rejects the change.
    """
    if len(words) <= 1:
        raise UsageError("the value is missing", _EXAMPLE)
    if len(words) > 3:  # noqa: PLR2004 - node, name and value
        raise UsageError("there are more words after the value", "put the value in quotes")
    graph, client = look(timeout)
    target = named(graph, *words[:-1])
    texts = _texts(client, target, words[-1])
    parameters = client.request(target.node.name, texts)
    for name in texts:
        write_note(f"{target.node.name}/{name} is now {parameters[name].value}")


def _texts(client: ParameterClient, target: ParameterTarget, value: str) -> Mapping[str, str]:
    if target.parameter is not None:
        return {target.parameter: value}
    values = parse_values([value])
    if not isinstance(values, dict):
        raise UsageError(
            f"the parameter's name or its value is missing, for {target.node.name}", _EXAMPLE
        )
    known = client.request(target.node.name)
    flat = {known_name(path, known) or "/".join(path): part for path, part in _leaves(values)}
    kinds = {name: known[name].type if name in known else ANY for name in flat}
    return {name: text_of(part, kinds[name]) for name, part in flat.items()}


def _leaves(values: Mapping[str, Value]) -> Iterator[tuple[tuple[str, ...], Value]]:
    """Yield the values of nested dicts, each with the keys that lead to it."""
    for key, part in values.items():
        if part and isinstance(part, Mapping):
            yield from (((key, *path), value) for path, value in _leaves(part))
        else:
            yield (key,), part
