"""The errors that lcmtools raises for its users to read.

    LcmtoolsError        an operation failed                          exit code 1
    +-- UsageError       what was typed is wrong                      exit code 2
    |   +-- InvalidName      a name breaks the naming rules
    |   +-- InvalidUrl       an LCM URL is wrong, or liblcm would misread it
    |   +-- UnknownType      no such message type
    |   +-- ValueMismatch    a value does not fit the message's field
    |   +-- InvalidFile      a world, YAML or other input file is wrong
    +-- DecodeError      a payload is damaged or has another type
    +-- BusError         the bus cannot be reached or used
    |   +-- BusOfParent      it belongs to the parent of a forked process
    +-- ServiceError     a service call failed or was not answered
    |   +-- ServiceTimeout   a service call was not answered in time  exit code 4
    +-- MissingExtra     an optional dependency is not installed      exit code 3
    +-- NothingReceived  no message arrived in time                   exit code 4

Every error states the fault and its place (``what``) and, if there is one, the remedy (``hint``).
Library code raises; only ``lcmtools.cli`` prints errors and turns them into exit codes. Must not
know anything else of lcmtools.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TypeVar, cast

FunctionT = TypeVar("FunctionT", bound=Callable[..., object])


class LcmtoolsError(Exception):
    """An operation failed.

    Attributes:
        what: The error and its place, in one line without a full stop.
        hint: The remedy, or "".
    """

    exit_code = 1

    def __init__(self, what: str, hint: str = "") -> None:
        super().__init__(what, hint)
        self.what = what
        self.hint = hint

    def __str__(self) -> str:
        """Return the error and its remedy in one line."""
        return f"{self.what}; {self.hint}" if self.hint else self.what


@contextmanager
def os_errors_as(
    what: str, hint: str = "", kind: type[LcmtoolsError] = LcmtoolsError
) -> Iterator[None]:
    """Convert OSError and UnicodeDecodeError: "cannot write a.txt: Permission denied"."""
    try:
        yield
    except OSError as error:
        raise kind(f"{what}: {error.strerror or error}", hint) from error
    except UnicodeDecodeError as error:
        raise kind(f"{what}: it is not UTF-8 text", hint) from error


class UsageError(LcmtoolsError):
    """A mistake in the arguments."""

    exit_code = 2


class InvalidName(UsageError):  # noqa: N818 - named for what happened, as in httpx
    """A name breaks the rules for topic, node or channel names."""


class InvalidUrl(UsageError):  # noqa: N818
    """An LCM URL is wrong, or liblcm would misread it."""


class UnknownType(UsageError):  # noqa: N818
    """There is no message type of this name."""


class ValueMismatch(UsageError):  # noqa: N818
    """A value does not fit a field of a message."""


class InvalidFile(UsageError):  # noqa: N818
    """An input file (world, YAML) cannot be read or is wrong."""


class DecodeError(LcmtoolsError):
    """A payload is truncated, damaged, or of another type than expected."""


class BusError(LcmtoolsError):
    """The bus cannot be reached or used."""


class BusOfParent(BusError):  # noqa: N818
    """The bus, or a node on it, belongs to the parent of this forked process."""


class ServiceError(LcmtoolsError):
    """A service call failed at the server or was not answered in time."""


class ServiceTimeout(ServiceError):  # noqa: N818
    """A service call was not answered in time."""

    exit_code = 4


class MissingExtra(LcmtoolsError):  # noqa: N818
    """An optional dependency is not installed."""

    exit_code = 3


@contextmanager
def needing_extra(extra: str, who_needs: str, otherwise: str = "") -> Iterator[None]:
    """Convert a failed import into MissingExtra: "MCAP needs" the extra "mcap"."""
    try:
        yield
    except (ImportError, MissingExtra) as error:
        if (getattr(error, "name", None) or "").startswith("lcmtools"):
            raise  # a fault of lcmtools
        reason = " ".join(str(error.__cause__ or error).split())
        what = f"{who_needs} the extra '{extra}' ({reason})"
        raise MissingExtra(what, extra_hint(extra) + otherwise) from error


def extra_hint(extra: str) -> str:
    """Return the command that installs an extra, for a hint."""
    return f"type: pip install 'lcmtools-robotics[{extra}]'"


class NothingReceived(LcmtoolsError):  # noqa: N818
    """No message arrived within the given time."""

    exit_code = 4


def explained(function: FunctionT) -> FunctionT:
    """Decorate a function: calls with wrong arguments raise UsageError with its signature."""

    @wraps(function)
    def call(*arguments: object, **keywords: object) -> object:
        try:
            return function(*arguments, **keywords)
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next:  # raised inside
                raise
            fault = _call_fault(function, error)
        raise fault  # without the error, which says the same

    return cast("FunctionT", call)


def _call_fault(function: Callable[..., object], error: TypeError) -> UsageError:
    """Return the error for a call with wrong arguments."""
    import inspect  # late: it takes some milliseconds

    reason = str(error).partition("() ")[2]
    if reason.endswith("given"):  # Python counts self too
        reason = "got too many arguments"
    names = ", ".join(
        f"{one.name.removesuffix('s')}, ..."
        if one.kind is one.VAR_POSITIONAL
        else one.name
        if one.default is one.empty
        else f"{one.name}={one.default!r}"
        for one in inspect.signature(function).parameters.values()
        if one.name != "self"
    )
    owner, _, name = function.__qualname__.rpartition(".")
    name = owner if name == "__init__" else name
    return UsageError(f"{name} {reason}", f"write {name}({names})")
