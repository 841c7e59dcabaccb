"""Checks for wrong uses of the Python API, each explained in one line: the expected, the actual.

Belongs here: checking arguments, and the texts of the errors. Must not know nodes, the bus or the
log. Each check raises a UsageError that says what to write.
"""

import inspect
import math
from collections.abc import Callable, Sequence
from functools import wraps
from types import ModuleType
from typing import TypeVar, cast

from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.layout import is_generated
from lcmtools.messages.registry import Message, message_class, service_class, type_name
from lcmtools.messages.scalars import given

FunctionT = TypeVar("FunctionT", bound=Callable[..., object])

_OF_SERVICES = ("create_service", "create_client")
_WITH_CALLBACK = ("create_subscription", "create_service")
_LONGEST_USUAL_PERIOD = 60.0  # [s]; a longer one is more often meant in milliseconds


def check_text(call: str, what: str, value: object) -> None:
    """Make sure that a name is a string."""
    if not isinstance(value, str):
        hint = "the callback comes after it" if inspect.isroutine(value) else ""
        raise UsageError(f"{call}: the {what} is a text, got {described(value)}", hint)


def type_first(function: FunctionT) -> FunctionT:
    """Decorate a method that takes a type and a name: a call without the type raises UsageError."""

    @wraps(function)
    def call(node: object, *arguments: object, **keywords: object) -> object:
        _check_first(function.__name__, arguments)
        return function(node, *arguments, **keywords)

    return cast("FunctionT", call)


def _check_first(call: str, arguments: Sequence[object]) -> None:
    """Make sure that the first argument is not the name of a topic or a service."""
    name, *others = arguments or (None,)
    is_service = call in _OF_SERVICES
    find: Callable[[str], type] = service_class if is_service else message_class
    if not isinstance(name, str) or _is_known(find, name):
        return
    if not others or not (isinstance(others[0], (str, type)) or is_generated(type(others[0]))):
        kind = "Trigger" if is_service else "Twist"
        rest = ", callback" if call in _WITH_CALLBACK else ""
        shows = f"lcmtools {'service info' if is_service else 'info'} {name} shows it"
        hint = f"write {call}({kind}, {name!r}{rest}) if it is {kind}; {shows}"
        raise UsageError(f"{call}: the type is missing before {name!r}", hint)


def check_endpoint(call: str, kinds: Sequence[object], topic: object, depth: object) -> None:
    """Make sure that these are message classes, a topic and the depth of a queue."""
    for kind in kinds:
        if not (isinstance(kind, type) and is_generated(kind)):
            raise _type_fault(call, kind, topic)
    if not kinds:
        raise UsageError(f"{call}: there is no type")
    check_text(call, "topic", topic)
    if not topic:  # it would be the namespace itself
        raise UsageError(f"{call}: the topic is empty")
    if not hasattr(depth, "__index__"):
        got = described(depth)
        raise UsageError(f"{call}: the depth is a number of messages, such as 10; got {got}")


def check_service_type(call: str, kind: object, name: object) -> None:
    """Make sure that these are a service's class and name."""
    if not (isinstance(kind, type) and is_generated(getattr(kind, "Request", int))):
        raise _type_fault(call, kind, name, is_service=True)
    check_text(call, "service's name", name)


def check_callback(call: str, callback: object, *arguments: str) -> None:
    """Make sure that a callback can be called with these arguments, which the error names."""
    if callback is None or inspect.iscoroutine(callback):
        got = "None" if callback is None else "a coroutine"
        if callback is not None:
            callback.close()  # Python would warn that it was never awaited
        hint = "give the function without parentheses: self.tick, not self.tick()"
        raise UsageError(f"{call}: the callback is {got}, perhaps the result of a call", hint)
    if not callable(callback):
        raise UsageError(f"{call}: the callback is {described(callback)}, not a function")
    name = getattr(callback, "__name__", type(callback).__name__)
    if inspect.iscoroutinefunction(callback):
        raise UsageError(f"{call}: the callback {name} is async", f"write def {name}, not async")
    try:
        signature = inspect.signature(callback)
    except (TypeError, ValueError):  # some built-in functions have no signature
        return
    try:
        signature.bind(*arguments)
    except TypeError:
        raise _arity_fault(call, name, list(signature.parameters), arguments) from None


def check_period(seconds: object) -> str:
    """Make sure that this is a timer's period; return a warning if it is very long, else ""."""
    if callable(seconds):
        hint = "write create_timer(0.1, self.tick)"
        raise UsageError("create_timer takes the period first", hint)
    if isinstance(seconds, (str, bool)) or not hasattr(seconds, "__float__"):
        got = described(seconds)
        raise UsageError(f"create_timer: the period is a number of seconds, got {got}")
    period = float(seconds)
    if not 0 < period < math.inf:
        raise UsageError(f"a timer's period must be positive and finite, got {seconds} s")
    if period <= _LONGEST_USUAL_PERIOD:
        return ""
    meant = f"if {period:g} ms are meant, write {period / 1000:g}"
    return f"create_timer: a period of {period:g} s; {meant}"


def period_of(frequency: object) -> float:
    """Return the period of a rate [s]."""
    number = frequency if isinstance(frequency, (int, float)) else 0
    if isinstance(frequency, bool) or not 0 < number < math.inf or math.isinf(1 / number):
        raise UsageError(f"create_rate takes a positive number of Hz, got {described(frequency)}")
    return 1 / number


def check_words(args: object) -> None:
    """Make sure that these are a list of command line arguments."""
    if isinstance(args, str):
        what = f"lcmtools.init takes the command line as a list of words, got {args!r}"
        raise UsageError(what, f"write lcmtools.init() and lcmtools.Node({args!r})")


def misfit(where: str, expected: str, kind: type, value: object) -> ValueMismatch:
    """Return the error for a value that is not a message of the class named ``expected``."""
    name = expected.rpartition("/")[2]
    fields = [field.name for field in visible_fields(kind)]
    is_scalar = isinstance(value, (bool, int, float, str))
    hint = ""
    if value is kind or isinstance(value, dict):
        hint = f"write message = {name}(), and fill it: message.{fields[0]} = ..." if fields else ""
    elif is_scalar and len(fields) == 1:
        hint = f"write message = {name}(); message.{fields[0]} = {described(value)}"
    return ValueMismatch(f"{where}: expected {expected}, got {described(value)}", hint)


def missing_attribute(node: object, name: str) -> Exception:
    """Return the error for an attribute that a node does not have."""
    from lcmtools.ros_words.python_names import METHODS

    cls = type(node).__name__
    if name.startswith(("_Node__", "_Parametric__", "_Factory__")) or name in ("name", "namespace"):
        first = f"begin it with: super().__init__('{cls.lower()}')"
        return UsageError(f"{cls}.__init__ has not called that of Node before", first)
    hint = f"; write {METHODS[name]}" if name in METHODS else ""
    return AttributeError(f"'{cls}' object has no attribute '{name}'{hint}", name=name, obj=node)


def _type_fault(call: str, kind: object, name: object, *, is_service: bool = False) -> UsageError:
    """Return the error for a value that is not a message class or a service class."""
    what = "service" if is_service else "message"
    find: Callable[[str], type] = service_class if is_service else message_class
    if isinstance(kind, str) and (isinstance(name, type) or _is_known(find, name)):
        second = name if isinstance(name, type) else find(str(name))
        rest = ", callback" if call in _WITH_CALLBACK else ""
        hint = f"write {call}({second.__name__}, {kind!r}{rest})"
        return UsageError(f"{call} takes the type first", hint)
    if isinstance(kind, str):
        what = f"{call}: the type is a class, not the text {kind!r}"
        return UsageError(what, f"write {_import(find(kind))}")
    if isinstance(kind, type):
        return _class_fault(call, kind, what, find)
    if is_generated(type(kind)):
        own = type(kind).__name__
        return UsageError(f"{call}: the type is the class {own}, not a message", f"write {own}")
    hint = f"write {_import(find('std_srvs/Trigger' if is_service else 'std_msgs/String'))}"
    return UsageError(f"{call}: the type is a {what} class, got {described(kind)}", hint)


def _class_fault(call: str, kind: type, what: str, find: Callable[[str], type]) -> UsageError:
    """Return the error for a class that is not a message's, or not a service's."""
    if is_generated(kind):
        whole = type_name(kind).partition("_Re")[0]
        hint = f"write {_import(service_class(whole))}" if _is_known(service_class, whole) else ""
        return UsageError(f"{call}: {type_name(kind)} is a message, not a service", hint)
    if is_generated(getattr(kind, "Request", int)):
        what = f"{call}: {kind.__name__} is a service, not a message"
        return UsageError(what, "see create_service")
    package = kind.__module__.partition(".")[0]
    known = f"{package}/{kind.__name__}"
    hint = f"write {_import(find(known))}" if _is_known(find, known) else ""
    return UsageError(f"{call}: {described(kind)} is not a {what} type of LCM", hint)


def _is_known(find: Callable[[str], type], name: object) -> bool:
    try:
        return isinstance(name, str) and bool(find(name))
    except UsageError:
        return False


def _import(kind: type) -> str:
    """Return the line that imports a class."""
    package = kind.__module__.rpartition(".")[0]
    if package.startswith("lcmtools.types"):
        return f"from {package} import {kind.__name__}"
    return f"lcmtools.message_class({type_name(kind)!r})"


def _arity_fault(call: str, name: str, takes: list[str], arguments: Sequence[str]) -> UsageError:
    called = f"{name}({', '.join(arguments)})"
    hint = f"write def {name}({', '.join(('self', *arguments))}) in a class"
    if takes[:1] == ["self"]:
        hint = f"give the method of an object: self.{name}"
    what = f"{call}: the callback {name}({', '.join(takes)}) is called as {called}"
    return UsageError(what, hint)


def described(value: object) -> str:
    """Return a short description of a value, for an error."""
    if isinstance(value, type):
        return f"the class {type_name(value) if is_generated(value) else value.__qualname__}"
    if is_generated(type(value)):
        return type_name(cast("Message", value))
    if isinstance(value, ModuleType):
        return f"the module {value.__name__}"
    if inspect.isroutine(value):
        return f"the function {value.__name__}"
    return "None" if value is None else given(value)
