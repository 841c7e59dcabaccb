"""The errors that lcmtools raises for its users to read.

    LcmtoolsError        something could not be done                  exit code 1
    +-- UsageError       what was typed is wrong                      exit code 2
    |   +-- InvalidName      a name breaks the naming rules
    |   +-- InvalidUrl       an LCM URL that liblcm would misread
    |   +-- UnknownType      no such message type
    |   +-- ValueMismatch    a value does not fit the message's field
    |   +-- InvalidFile      a world, YAML or other input file is wrong
    +-- DecodeError      a payload is not what its type says
    +-- BusError         the bus cannot be reached or used
    +-- ServiceError     a service call failed or was not answered
    |   +-- ServiceTimeout   it was not answered in time              exit code 4
    +-- MissingExtra     an optional dependency is not installed      exit code 3
    +-- NothingReceived  nothing came within the time given           exit code 4

Every error has the fault and its place (``what``) and, where there is one, the remedy (``hint``).
Library code raises; only ``lcmtools.cli`` prints errors and turns them into exit codes. This module
knows nothing else of lcmtools.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TypeVar, cast

FunctionT = TypeVar("FunctionT", bound=Callable[..., object])


class LcmtoolsError(Exception):
    """Something could not be done.

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
        """Both parts in one line, as a command prints them."""
        return f"{self.what}; {self.hint}" if self.hint else self.what


@contextmanager
def os_errors_as(
    what: str, hint: str = "", kind: type[LcmtoolsError] = LcmtoolsError
) -> Iterator[None]:
    """Raise the system's errors as an error of ours: "cannot write a.txt: Permission denied".

    Text that is not UTF-8 is one of them.
    """
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
    """An LCM URL is wrong, or would be read by liblcm as something else than it says."""


class UnknownType(UsageError):  # noqa: N818
    """No message type of this name is known."""


class ValueMismatch(UsageError):  # noqa: N818
    """A value does not fit the message field it is meant for."""


class InvalidFile(UsageError):  # noqa: N818
    """An input file (world, YAML) cannot be read or is wrong."""


class DecodeError(LcmtoolsError):
    """A payload is truncated, too short or of another type than expected."""


class BusError(LcmtoolsError):
    """The bus cannot be reached or used."""


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
    """Raise an import that fails as MissingExtra: "MCAP needs" the extra "mcap"."""
    try:
        yield
    except (ImportError, MissingExtra) as error:
        if (getattr(error, "name", None) or "").startswith("lcmtools"):
            raise  # a fault of ours
        reason = " ".join(str(error.__cause__ or error).split())
        what = f"{who_needs} the extra '{extra}' ({reason})"
        raise MissingExtra(what, extra_hint(extra) + otherwise) from error


def extra_hint(extra: str) -> str:
    """Return what installs an extra, from a checkout or not."""
    return f"type: pip install 'lcmtools-robotics[{extra}]'"


class NothingReceived(LcmtoolsError):  # noqa: N818
    """Nothing came within the time given."""

    exit_code = 4


def explained(function: FunctionT) -> FunctionT:
    """Let calls that do not fit a function's signature raise a UsageError that shows it."""

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
    """Return the error for a call that does not fit a function's signature."""
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
