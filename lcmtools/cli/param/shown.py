"""Parameters as they are printed: YAML that ``param load`` takes, and JSON."""

import json
from collections.abc import Mapping

from lcmtools.cli.param.ask import Answers
from lcmtools.messages.plain import plain_json
from lcmtools.messages.setting import Setting, write_setting
from lcmtools.node.remote import RemoteParameter

Parameters = Mapping[str, RemoteParameter]


def block(parameters: Parameters, indent: str = "") -> list[str]:
    """The lines of a node's parameters."""
    return [f"{indent}{write_setting(name)}: {p.text}" for name, p in parameters.items()]


def tree(answers: Answers) -> list[str]:
    """The lines of several nodes' parameters, below the nodes' names."""
    return [
        row
        for node, parameters in answers.items()
        for row in (f"{write_setting(node)}:", *block(parameters, "  "))
    ]


def pretty(value: Setting) -> str:
    """A value for people: a text without quotes."""
    return value if isinstance(value, str) else write_setting(value)


def json_value(parameter: RemoteParameter) -> object:
    """A value for JSON; infinities and NaN as text."""
    value = parameter.value()
    if value is None:
        return None
    plain = list(value) if isinstance(value, (list, tuple)) else value
    return json.loads(plain_json(plain))  # type: ignore[arg-type] # a list of scalars


def json_values(parameters: Parameters) -> dict[str, object]:
    """The values of a node's parameters for JSON."""
    return {name: json_value(parameter) for name, parameter in parameters.items()}


def record(node: str, parameter: RemoteParameter) -> dict[str, object]:
    """All that is known of a parameter, for JSON."""
    return {
        "node": node,
        "name": parameter.name,
        "type": parameter.kind,
        "value": json_value(parameter),
        "description": parameter.description,
        "minimum": parameter.minimum or None,
        "maximum": parameter.maximum or None,
        "read_only": parameter.read_only,
    }
