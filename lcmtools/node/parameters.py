"""The parameters of one node: declared, read, and changed by itself or over the bus.

The bus reaches them by a hidden service of the node, ``<node>/_parameters``. What a node is beyond
its name is not known here.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.setting import check_setting, read_setting, write_setting
from lcmtools.names import did_you_mean
from lcmtools.node.parameter import (
    Parameter,
    ParameterDescriptor,
    ParameterValue,
    SetParametersResult,
)
from lcmtools.types import lcmtools_msgs as msgs

ParametersCallback = Callable[[list[Parameter[ParameterValue]]], SetParametersResult | None]
"""Called with parameters as they are to be; says whether they may."""


@dataclass(frozen=True, slots=True)
class _Declared:
    """A parameter with what was said when it was declared."""

    value: ParameterValue
    descriptor: ParameterDescriptor


def service_name(node: str) -> str:
    """The hidden service that a node's parameters are asked for and changed by."""
    return f"{node}/_parameters"


class Parameters:
    """The parameters of a node.

    Args:
        node: The node's full name, for messages.
        given: The command line's texts, by parameter.
    """

    def __init__(self, node: str, given: Mapping[str, str]) -> None:
        self._node = node
        self._given = given
        self._declared: dict[str, _Declared] = {}
        self.callbacks: list[ParametersCallback] = []
        """Asked before a change, the newest first."""

    def declare(
        self, name: str, default: ParameterValue, descriptor: ParameterDescriptor
    ) -> ParameterValue:
        """Take a parameter in; return its value, which is the default unless one was given.

        Raises:
            UsageError: It is declared already, or a value is of another type or out of range.
        """
        if name in self._declared:
            raise UsageError(f"{self._node} declares its parameter '{name}' twice")
        if not name:
            raise UsageError(f"{self._node} declares a parameter without a name")
        text, path = self._given.get(name), f"parameter {name}"
        value = check_setting(default, descriptor.kind, path)
        if text is not None:
            value = read_setting(text, descriptor.kind, path)
        check_range(name, value, descriptor)
        self._declared[name] = _Declared(value, descriptor)
        return value

    def __contains__(self, name: str) -> bool:
        """Return whether a parameter of this name is declared."""
        return name in self._declared

    def get(self, name: str) -> Parameter[ParameterValue]:
        """A parameter as it is now.

        Raises:
            UsageError: It was not declared.
        """
        return Parameter(name, self._find(name).value)

    def descriptor(self, name: str) -> ParameterDescriptor:
        """The description of a parameter.

        Raises:
            UsageError: It was not declared.
        """
        return self._find(name).descriptor

    def change(self, wanted: Sequence[Parameter[ParameterValue]]) -> SetParametersResult:
        """Set all of these parameters, or none of them.

        What a callback raises goes on to the caller; an LcmtoolsError of it is a refusal.
        """
        try:
            checked = [self._checked(parameter) for parameter in wanted]
            for callback in reversed(self.callbacks):
                result = callback(list(checked))
                if result is not None and not result.successful:
                    return replace(result, reason=result.reason or "the node refuses it")
        except LcmtoolsError as error:
            return SetParametersResult(successful=False, reason=str(error))
        changed = {p.name: replace(self._declared[p.name], value=p.value) for p in checked}
        self._declared = {**self._declared, **changed}  # in one step, for other threads that read
        return SetParametersResult()

    def answer(
        self, request: msgs.Parameters_Request, response: msgs.Parameters_Response
    ) -> msgs.Parameters_Response:
        """Serve the bus: change what is asked for, all or nothing, and tell all parameters."""
        errors: list[str] = []
        wanted = [parameter for c in request.changes for parameter in self._read(c, errors)]
        if wanted and not errors:
            result = self.change(wanted)
            errors = [] if result.successful else [result.reason]
        response.errors = errors
        response.parameters = [_message(*item) for item in sorted(self._declared.items())]
        return response

    def _read(
        self, change: msgs.Parameter, errors: list[str]
    ) -> Iterator[Parameter[ParameterValue]]:
        """The parameter that a change means, or none and why."""
        try:
            kind = self._find(change.name).descriptor.kind
            value = read_setting(change.value, kind, f"parameter {change.name}")
        except UsageError as error:
            errors.append(str(error))
        else:
            yield Parameter(change.name, value)

    def _checked(self, wanted: Parameter[ParameterValue]) -> Parameter[ParameterValue]:
        """A parameter of the declared type, within its range."""
        declared = self._find(wanted.name)
        path, descriptor = f"parameter {wanted.name}", declared.descriptor
        value = check_setting(wanted.value, descriptor.kind, path)
        if descriptor.read_only and value != declared.value:
            raise UsageError(
                f"{path} cannot change while the node runs",
                f"start it again with _{wanted.name}:={write_setting(value)}",
            )
        check_range(wanted.name, value, descriptor)
        return Parameter(wanted.name, value)

    def _find(self, name: str) -> _Declared:
        if name not in self._declared:
            raise UsageError(
                f"{self._node} has no parameter '{name}'",
                did_you_mean(name, self._declared) or f"it has {', '.join(self._declared)}",
            )
        return self._declared[name]


def check_range(name: str, value: ParameterValue, descriptor: ParameterDescriptor) -> None:
    """Refuse numbers out of a parameter's range; what is not a number is in none.

    Raises:
        UsageError: The value, or an element of it, is too small or too large.
    """
    low, high = descriptor.minimum, descriptor.maximum
    numbers = value if isinstance(value, (list, tuple)) else [value]
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, (int, float)):
            continue
        if low is not None and not number >= low:
            raise UsageError(f"parameter {name}: {number} is less than {low}")
        if high is not None and not number <= high:
            raise UsageError(f"parameter {name}: {number} is more than {high}")


def _message(name: str, declared: _Declared) -> msgs.Parameter:
    message, descriptor = msgs.Parameter(), declared.descriptor
    message.name, message.type = name, descriptor.kind
    message.value, message.description = write_setting(declared.value), descriptor.description
    message.minimum, message.maximum = _limit(descriptor.minimum), _limit(descriptor.maximum)
    message.read_only = descriptor.read_only
    return message


def _limit(limit: float | None) -> str:
    return "" if limit is None else write_setting(limit)
