"""The part of a node that its parameters are set and read by, in rclpy's shape.

What becomes of them is ``parameters``' business; the bus is not known here.
"""

from collections.abc import Mapping, Sequence
from typing import cast

from lcmtools.messages.setting import kind_of
from lcmtools.node.parameter import (
    Parameter,
    ParameterDescriptor,
    ParameterValue,
    SetParametersResult,
    ValueT,
)
from lcmtools.node.parameters import Parameters, ParametersCallback
from lcmtools.types import lcmtools_msgs as msgs


class Parametric:
    """A mixin for objects with parameters.

    Args:
        name: Its full name, for messages.
        given: The command line's texts, by parameter.
        known: Takes the name of each parameter that is declared.
    """

    # Private names begin with two underscores, as in Node.

    def __init__(self, name: str, given: Mapping[str, str], known: set[str]) -> None:
        self.__parameters = Parameters(name, given)
        self.__known = known

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
        """Declare a setting with its default; ``_name:=value`` on the command line wins.

        It can be changed while the node runs, over the bus too: ``get_parameter`` has its value.

        Args:
            name: Its name, without the node's.
            default: Its default, whose type all values have.
            description: What it is for, with the unit.
            minimum: Smallest number that it may be; None for any.
            maximum: Largest number that it may be; None for any.
            read_only: It cannot change while the node runs.

        Raises:
            UsageError: The command line's value is not of the default's type or out of range, or
                the parameter is declared already.
        """
        descriptor = ParameterDescriptor(kind_of(default), description, minimum, maximum, read_only)
        value = self.__parameters.declare(name, default, descriptor)
        self.__known.add(name)
        return Parameter(name, cast("ValueT", value))  # declare gives the default's own type

    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter is declared."""
        return name in self.__parameters

    def get_parameter(self, name: str) -> Parameter[ParameterValue]:
        """A declared parameter as it is now.

        Raises:
            UsageError: It was not declared.
        """
        return self.__parameters.get(name)

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """The description given when a parameter was declared.

        Raises:
            UsageError: It was not declared.
        """
        return self.__parameters.descriptor(name)

    def set_parameters(
        self, parameters: Sequence[Parameter[ParameterValue]]
    ) -> list[SetParametersResult]:
        """Change parameters one by one; say of each whether it was."""
        return [self.__parameters.change([parameter]) for parameter in parameters]

    def set_parameters_atomically(
        self, parameters: Sequence[Parameter[ParameterValue]]
    ) -> SetParametersResult:
        """Change all of these parameters, or none of them."""
        return self.__parameters.change(parameters)

    def add_on_set_parameters_callback(self, callback: ParametersCallback) -> None:
        """Ask ``callback`` before parameters change, on the thread that spins.

        It is given the parameters as they are to be, and refuses them by returning
        SetParametersResult(False, reason) or by raising an LcmtoolsError.
        """
        self.__parameters.callbacks.append(callback)

    def remove_on_set_parameters_callback(self, callback: ParametersCallback) -> None:
        """Ask ``callback`` no more.

        Raises:
            ValueError: It was not asked.
        """
        self.__parameters.callbacks.remove(callback)

    def answer_parameters(
        self, request: msgs.Parameters_Request, response: msgs.Parameters_Response
    ) -> msgs.Parameters_Response:
        """Answer a request to the node's hidden parameter service."""
        return self.__parameters.answer(request, response)
