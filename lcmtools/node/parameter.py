"""Parameters: a node's settings, given on its command line as ``_gain:=2.0``."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from lcmtools.errors import UsageError

ParameterValue = bool | int | float | str | Sequence[bool | int | float | str] | None


ValueT = TypeVar("ValueT", bound=ParameterValue)


@dataclass(frozen=True, slots=True)
class Parameter(Generic[ValueT]):
    """A setting of a node.

    Attributes:
        name: Its name, without the node's.
        value: Its value, of the type of its default.
    """

    name: str
    value: ValueT


def read_parameter(name: str, text: str, default: ParameterValue) -> ParameterValue:
    """The value that a text on the command line means, of the default's type.

    Raises:
        UsageError: The text is no value of that type.
    """
    if isinstance(default, str):
        return _unquoted(text)
    if isinstance(default, float):
        try:  # not YAML's word for it: YAML 1.1 takes 1e-3 for text
            return float(text)
        except ValueError:
            raise UsageError(f"parameter {name}: expected a number, got '{text}'") from None
    import yaml

    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise UsageError(f"parameter {name}: '{text}' is not YAML") from error
    if isinstance(default, bool):
        return _require(name, text, value, bool, "true or false")
    if isinstance(default, int):
        return _require(name, text, value, int, "a whole number")
    if isinstance(default, Sequence):
        return _require(name, text, value, list, "a list")
    return value  # type: ignore[no-any-return]


def _unquoted(text: str) -> str:
    """A text as it is: quotes around it are the YAML of somebody who wants to be sure."""
    is_quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "'\""
    return text[1:-1] if is_quoted else text


def _require(
    name: str, text: str, value: object, kind: type, expected: str
) -> bool | int | list[bool | int | float | str]:
    if isinstance(value, kind) and (kind is bool or not isinstance(value, bool)):
        return value  # type: ignore[return-value]
    raise UsageError(f"parameter {name}: expected {expected}, got '{text}'")
