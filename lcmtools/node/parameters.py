"""A node's parameters as in rclpy: declared, read and changed, also over the bus.

The bus accesses them through a hidden service of the node, ``<node>/_parameters``. The other parts
of a node are not known here.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar, cast

from lcmtools.errors import LcmtoolsError, UsageError, explained
from lcmtools.messages.setting import (
    ParameterValue,
    check_setting,
    kind_of,
    read_setting,
    write_setting,
)
from lcmtools.names import did_you_mean
from lcmtools.node.checks import check_callback, check_text, described
from lcmtools.types import lcmtools_msgs as msgs

PARAMETERS_SUFFIX = "/_parameters"
"""The suffix of the name of the hidden service for a node's parameters."""

ValueT = TypeVar("ValueT", bound=ParameterValue)


@dataclass(frozen=True, slots=True)
class Parameter(Generic[ValueT]):
    """A setting of a node.

    Attributes:
        name: Its name, without the node's.
        value: A boolean, a number, a text, a list of these, or None, of its default's type.
    """

    name: str
    value: ValueT

    @explained
    def __init__(self, name: str, value: ValueT) -> None:
        check_text("Parameter", "name", name)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "value", value)


@dataclass(frozen=True, slots=True)
class ParameterDescriptor:
    """The description of a parameter.

    Attributes:
        kind: Its type, fixed by its default: see lcmtools.messages.setting.kind_of.
        description, minimum, maximum, read_only: As for ``Node.declare_parameter``.
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
        successful: True if they were set; from a callback: True if they may be.
        reason: The reason if not.
    """

    successful: bool = True
    reason: str = ""


ParametersCallback = Callable[[list[Parameter[ParameterValue]]], SetParametersResult | None]
"""Called with the new parameters before they are set; may refuse them."""


@dataclass(frozen=True, slots=True)
class _Declared:
    value: ParameterValue
    descriptor: ParameterDescriptor

    def message(self, name: str) -> msgs.Parameter:
        message, descriptor = msgs.Parameter(), self.descriptor
        message.name, message.type = name, descriptor.kind
        message.value, message.description = write_setting(self.value), descriptor.description
        low, high = descriptor.minimum, descriptor.maximum
        message.minimum = "" if low is None else write_setting(low)
        message.maximum = "" if high is None else write_setting(high)
        message.read_only = descriptor.read_only
        return message


def service_name(node: str) -> str:
    """Return the name of the hidden service for a node's parameters."""
    return f"{node}{PARAMETERS_SUFFIX}"


class Parametric:
    """A mixin for objects with parameters.

    ``given`` has the command line's values as text, by parameter; ``known`` collects the names of
    all declared parameters. ``name`` is the full one, for messages.
    """

    # Private names begin with two underscores, as in Node.

    def __init__(self, name: str, given: Mapping[str, str], known: set[str]) -> None:
        self.__name = name
        self.__given = given
        self.__known = known
        self.__declared: dict[str, _Declared] = {}
        self.__on_set: list[ParametersCallback] = []

    @explained
    def declare_parameter(
        self,
        name: str,
        default: ValueT,
        description: str = "",
        *,
        minimum: float | None = None,
        maximum: float | None = None,
        read_only: bool = False,
    ) -> Parameter[ValueT]:
        """Declare a setting with its default; ``_name:=value`` on the command line overrides it.

        It can be changed while the node runs, also over the bus: ``get_parameter`` has its value.

        Args:
            name: Its name, without the node's.
            default: Its default; all values must have its type.
            description: Its meaning, with the unit.
            minimum: Its smallest allowed number; None for any.
            maximum: Its largest allowed number; None for any.
            read_only: It cannot change while the node runs.

        Raises:
            UsageError: The command line's value is not of the default's type or out of range, or
                the parameter is declared already.
        """
        if name in self.__declared:
            raise UsageError(f"{self.__name} declares its parameter '{name}' twice")
        check_text("declare_parameter", "name", name)
        if not name:
            raise UsageError(f"{self.__name} declares a parameter without a name")
        descriptor = ParameterDescriptor(kind_of(default), description, minimum, maximum, read_only)
        value = check_setting(default, descriptor.kind, f"parameter {name}")
        if name in self.__given:
            value = read_setting(self.__given[name], descriptor.kind, f"parameter {name}")
        _check_range(name, value, descriptor)
        self.__declared[name] = _Declared(value, descriptor)
        self.__known.add(name)
        return Parameter(name, cast("ValueT", value))  # checked to be of the default's type

    @explained
    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter is declared."""
        return name in self.__declared

    @explained
    def get_parameter(self, name: str) -> Parameter[ParameterValue]:
        """Return a declared parameter with its current value.

        Raises:
            UsageError: It was not declared.
        """
        return Parameter(name, self.__find(name).value)

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return the description given when a parameter was declared.

        Raises:
            UsageError: It was not declared.
        """
        return self.__find(name).descriptor

    @explained
    def set_parameters(
        self, parameters: Sequence[Parameter[ParameterValue]]
    ) -> list[SetParametersResult]:
        """Change parameters one by one; return the result of each.

        Raises:
            UsageError: It is not a list of Parameter.
        """
        _check_parameters(parameters)
        return [self.set_parameters_atomically([parameter]) for parameter in parameters]

    @explained
    def set_parameters_atomically(
        self, parameters: Sequence[Parameter[ParameterValue]]
    ) -> SetParametersResult:
        """Change all of these parameters, or none of them.

        A callback's LcmtoolsError is a refusal; its other exceptions are raised to the caller.

        Raises:
            UsageError: It is not a list of Parameter.
        """
        _check_parameters(parameters)
        try:
            checked = [self.__checked(parameter) for parameter in parameters]
            for callback in reversed(self.__on_set):
                result = callback(list(checked))
                if result is not None and not result.successful:
                    return replace(result, reason=result.reason or "no reason given")
        except LcmtoolsError as error:
            return SetParametersResult(successful=False, reason=str(error))
        changed = {p.name: replace(self.__declared[p.name], value=p.value) for p in checked}
        self.__declared = {**self.__declared, **changed}  # in one step, as other threads read it
        return SetParametersResult()

    @explained
    def add_on_set_parameters_callback(self, callback: ParametersCallback) -> None:
        """Call ``callback`` before parameters change, on the spinning thread; the newest first.

        It gets the new parameters, and refuses them by returning SetParametersResult(False, reason)
        or by raising an LcmtoolsError.

        Raises:
            UsageError: It cannot be called with one argument.
        """
        check_callback("add_on_set_parameters_callback", callback, "parameters")
        self.__on_set.append(callback)

    def remove_on_set_parameters_callback(self, callback: ParametersCallback) -> None:
        """Stop calling ``callback``.

        Raises:
            ValueError: It was not added.
        """
        self.__on_set.remove(callback)

    def answer_parameters(
        self, request: msgs.Parameters_Request, response: msgs.Parameters_Response
    ) -> msgs.Parameters_Response:
        """Answer the service: make the requested changes, all or none; return all parameters."""
        errors: list[str] = []
        requested: list[Parameter[ParameterValue]] = []
        for change in request.changes:
            try:
                kind = self.__find(change.name).descriptor.kind
                value = read_setting(change.value, kind, f"parameter {change.name}")
                requested.append(Parameter(change.name, value))
            except UsageError as error:  # noqa: PERF203 - each change has its own
                errors.append(str(error))
        if requested and not errors:
            result = self.set_parameters_atomically(requested)
            errors = [] if result.successful else [result.reason]
        response.errors = errors
        response.parameters = [one.message(name) for name, one in sorted(self.__declared.items())]
        return response

    def __checked(self, parameter: Parameter[ParameterValue]) -> Parameter[ParameterValue]:
        """Return a parameter, its value converted to the declared type and checked for range."""
        name = parameter.name
        declared = self.__find(name)
        value = check_setting(parameter.value, declared.descriptor.kind, f"parameter {name}")
        if declared.descriptor.read_only and value != declared.value:
            hint = f"start it again with _{name}:={write_setting(value)}"
            raise UsageError(f"parameter {name} cannot change while the node runs", hint)
        _check_range(name, value, declared.descriptor)
        return Parameter(name, value)

    def __find(self, name: str) -> _Declared:
        if name not in self.__declared:
            hint = did_you_mean(name, self.__declared) or f"it has {', '.join(self.__declared)}"
            raise UsageError(f"{self.__name} has no parameter '{name}'", hint)
        return self.__declared[name]


def _check_parameters(parameters: object) -> None:
    rows = list(parameters) if isinstance(parameters, (list, tuple)) else [None]
    if not all(isinstance(row, Parameter) for row in rows):
        what = f"parameters are set by a list of Parameter, got {described(parameters)}"
        raise UsageError(what, "write set_parameters([lcmtools.Parameter('name', value)])")


def _check_range(name: str, value: ParameterValue, descriptor: ParameterDescriptor) -> None:
    """Refuse a value, or an element of it, out of range; NaN is in no range."""
    low, high = descriptor.minimum, descriptor.maximum
    for number in value if isinstance(value, (list, tuple)) else [value]:
        if isinstance(number, bool) or not isinstance(number, (int, float)):
            continue
        if low is not None and not number >= low:
            raise UsageError(f"parameter {name}: {number} is less than {low}")
        if high is not None and not number <= high:
            raise UsageError(f"parameter {name}: {number} is more than {high}")
