"""A parameter's value and description, and what an attempt to set it came to: plain values.

What a node does with its parameters is ``parameters``' business.
"""

from dataclasses import dataclass
from typing import Generic, TypeVar

from lcmtools.messages.setting import Setting

ParameterValue = Setting
"""A parameter's value: a boolean, a number, a text, a list of these, or None."""

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


@dataclass(frozen=True, slots=True)
class ParameterDescriptor:
    """The description of a parameter.

    Attributes:
        kind: Its type, fixed by its default: see lcmtools.messages.setting.kind_of.
        description: What it is for.
        minimum: Smallest number that it may be; None for any.
        maximum: Largest number that it may be; None for any.
        read_only: It cannot change while the node runs.
    """

    kind: str
    description: str = ""
    minimum: float | None = None
    maximum: float | None = None
    read_only: bool = False


@dataclass(frozen=True, slots=True)
class SetParametersResult:
    """The result of setting parameters, or a callback's verdict on it.

    Attributes:
        successful: They were; a callback says: they may be.
        reason: Why not.
    """

    successful: bool = True
    reason: str = ""
