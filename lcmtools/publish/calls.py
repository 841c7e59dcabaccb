"""Calling services for commands: the types and values of calls, waiting, requests at a rate."""

import itertools
import os
import re
import time
from collections.abc import Iterator, Sequence

from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError, NothingReceived, ServiceTimeout, UnknownType, UsageError
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import Message, ServiceType, service_class, service_name
from lcmtools.node.service import Client
from lcmtools.observe.reading.find import OfferedService, near_service, offered_services
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.publish.incoming import Notify, Template
from lcmtools.publish.schedule import due_times
from lcmtools.publish.subscriber_wait import wait_until
from lcmtools.publish.temporary_node import temporary_node

_TYPE = re.compile(r"[A-Za-z]\w*[/.](srv[/.])?[A-Za-z]\w*", re.ASCII)
_USUAL_RATE = 1.0  # [Hz] of repeated calls
_POLL = 0.05  # [s]
_MOST_SHOWN = 8


def split_type(
    service: OfferedService, words: Sequence[str]
) -> tuple[type[ServiceType], list[str]]:
    """Return a call's type and its values: the first word may be a type, as in ros2.

    Raises:
        UsageError: The type is unknown, or not the service's.
        LcmtoolsError: The announced type is not known here.
    """
    announced = service.types[0] if service.types else ""
    if not words or not _is_type(service, words[0]):
        return service.type_class(), list(words)
    named = service_name(words[0])
    if announced and named != announced:
        raise UsageError(f"{service.name} is of type {announced}, not {named}", "leave it out")
    return service_class(named), list(words[1:])


def wait_for_service(monitor: BusMonitor, name: str, longest: float, notify: Notify) -> None:
    """Wait until a living node offers the service of this full name; ``notify`` if it takes long.

    Raises:
        NothingReceived: No node does within ``longest`` seconds.
    """

    def notify_waiting() -> None:
        known = [one.name for one in offered_services(monitor.graph(), show_all=False)]
        there = f"there is {', '.join(known[:_MOST_SHOWN])}" if known else "no node offers any"
        notify(f"waiting for the service {name}; {there}")

    def is_offered() -> bool:
        return any(s.name == name and s.is_alive for s in offered_services(monitor.graph()))

    try:
        found = wait_until(is_offered, longest, notify_waiting, lambda _: monitor.receive(_POLL))
    except EOFError:
        raise LcmtoolsError(f"no node offers {name}: the log has ended") from None
    if not found:
        hint = near_service(monitor.graph(), name)
        raise NothingReceived(f"no node offers {name} within {longest:g} s", hint)


def call_all(
    service: OfferedService,
    service_type: type[ServiceType],
    requests: Iterator[Template],
    timeout: float,
    url: BusUrl,
) -> Iterator[Message]:
    """Call a service with each request, one after the other; yield the responses.

    Raises:
        ServiceTimeout: A response did not come in time; the error states what became of the server.
        ServiceError: The service reports a failure.
    """
    with temporary_node("service_call", url) as node:
        client: Client[Message, Message] = node.create_client(service_type, service.name)  # type: ignore[arg-type] # known by its name only
        try:
            for request in requests:
                yield client.call(request.at(time.time_ns()), timeout)
        except ServiceTimeout as error:
            raise ServiceTimeout(error.what, _state(service, url)) from None


def requests_in_time(
    requests: Sequence[Template], rate: float | None, times: int | None
) -> Iterator[Template]:
    """Yield requests when due, repeatedly; without ``rate`` and ``times``, each at once, and once.

    The default rate is 1 Hz. Requests that a slow service delayed do not follow in a burst.
    """
    if rate is None and times is None:
        yield from requests
        return
    due = due_times(rate or _USUAL_RATE)
    for request in itertools.islice(itertools.cycle(requests), times):
        time.sleep(max(0.0, next(due) - time.monotonic()))
        yield request


def _state(service: OfferedService, url: BusUrl) -> str:
    """The state of the node that did not answer, from another look at the bus."""
    server = service.servers[0][0]
    with BusMonitor(url, "service_call", os.environ) as monitor:
        now = [node for node in monitor.settle(foreign=False).nodes if node.id == server.id]
    if not now:
        return f"its node {server.name} has ended"
    if now[0].stale:
        return f"its node {server.name} {now[0].stale}"
    where = f"its node {server.name} (pid {server.pid})"
    return f"{where} is running: is it busy? --timeout 10s waits longer"


def _is_type(service: OfferedService, word: str) -> bool:
    """True if a word is a type, not a value: "maps/yard" is a value if a text is expected."""
    try:
        named = service_name(word)
    except UnknownType:
        return bool(_TYPE.fullmatch(word)) and "/" in word and not _begins_with_text(service)
    return "/" in word or "." in word or named in service.types


def _begins_with_text(service: OfferedService) -> bool:
    try:
        first = visible_fields(service.type_class().Request)[:1]
    except LcmtoolsError:
        return False
    return any(field.type == "string" for field in first)
