"""Service calls of pages; answers are kept, so that pages can unfold them."""

import time
from typing import Annotated

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.typed import Within
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, publishers_of
from lcmtools.gui.type_forms import filled_in
from lcmtools.messages.registry import Message, type_name
from lcmtools.node.service import Client
from lcmtools.observe.reading.find import find_service

_LONGEST_REASON = 500  # characters
_SHORTEST, _LONGEST = 0.01, 30.0  # [s] to wait for an answer


def call(
    source: Source,
    *,
    service: str,
    type: str,  # noqa: A002 - the key of a request
    values: Json,
    deadline: Annotated[float, Within(_SHORTEST, _LONGEST)] = 3.0,
) -> Json:
    """Call ``service`` with a form's request; return the number of the kept answer.

    The answer is waited for during ``deadline`` [s].

    Raises:
        UnknownType: The service's type is not known here.
        ValueMismatch: A value does not fit its field.
        LcmtoolsError: No node offers the service, or of another type than the form's.
        ServiceTimeout: It did not answer in time.
        ServiceError: It reports a failure.
    """
    publishers = publishers_of(source)
    found = find_service(source.latest.graph, service)
    kind, request = found.type_class(), filled_in(type, values)
    if not isinstance(request.message, kind.Request):
        expected = type_name(kind.Request)
        raise LcmtoolsError(f"{found.name} now expects {expected}", "choose it again")
    client: Client[Message, Message] = publishers.client(kind, found.name)  # type: ignore[arg-type] # known by its name only
    start = time.monotonic()
    response = client.call(request.at(time.time_ns()), deadline)
    return {
        "number": publishers.answers.keep(response),
        "seconds": time.monotonic() - start,
        "failure": _failure(response),
    }


def _failure(response: Message) -> str:
    """Return why a service failed, as Trigger and SetBool report it; "" if they do not."""
    if getattr(response, "success", True) is not False:
        return ""
    message = getattr(response, "message", "")
    words = message[:_LONGEST_REASON] if isinstance(message, str) else ""
    return f"it reports a failure: {words}" if words else "it reports a failure"
