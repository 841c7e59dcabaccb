"""Parameters as YAML for people and for files, and as values for JSON."""

from collections.abc import Iterator

from lcmtools.messages.setting import write_setting
from lcmtools.publish.remote_parameters import Answers, Parameters, value_of
from lcmtools.types.lcmtools_msgs import Parameter


def block(parameters: Parameters, indent: str = "") -> list[str]:
    """Return the lines of a node's parameters."""
    return [f"{indent}{write_setting(name)}: {p.value}" for name, p in parameters.items()]


def tree(answers: Answers) -> list[str]:
    """Return the lines of several nodes' parameters, below the nodes' names, for ``param load``."""
    blocks = ((f"{write_setting(node)}:", *block(has, "  ")) for node, has in answers.items())
    return [row for rows in blocks for row in rows]


def values(parameters: Parameters) -> dict[str, object]:
    """Return the values of a node's parameters for JSON."""
    return {name: value_of(parameter) for name, parameter in parameters.items()}


def all_values(answers: Answers) -> dict[str, object]:
    """Return the values of several nodes' parameters for JSON."""
    return {node: values(parameters) for node, parameters in answers.items()}


def to_json(node: str, parameter: Parameter) -> dict[str, object]:
    """Return a parameter with its description and range, for JSON."""
    return {
        "node": node,
        "name": parameter.name,
        "type": parameter.type,
        "value": value_of(parameter),
        "description": parameter.description,
        "minimum": parameter.minimum or None,
        "maximum": parameter.maximum or None,
        "read_only": parameter.read_only,
    }


def to_lines(node: str, parameter: Parameter) -> Iterator[str]:
    """Yield the lines of ``param describe``."""
    yield f"Parameter: {node}/{parameter.name}"
    yield f"  Type: {parameter.type}"
    yield f"  Value: {parameter.value}"
    if parameter.description:
        yield f"  Description: {parameter.description}"
    if parameter.minimum or parameter.maximum:
        yield f"  Range: {parameter.minimum or '-.inf'} to {parameter.maximum or '.inf'}"
    if parameter.read_only:
        yield "  Read only: it is set when the node starts"
