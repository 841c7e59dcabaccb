"""Services: a request channel and a reply channel, with an envelope of client and sequence number.

LCM has no calls. A client repeats its request until the reply with its sequence number arrives or
its timeout ends; the server executes each request once, and repeats its reply to a repeated one.
"""

import threading
import time
import uuid
from collections.abc import Callable
from typing import Generic, TypeVar

from lcmtools.bus.base import Bus
from lcmtools.errors import (
    BusError,
    DecodeError,
    LcmtoolsError,
    ServiceError,
    ServiceTimeout,
    UsageError,
    explained,
)
from lcmtools.graph.model import Endpoint, Role
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.node.checks import misfit
from lcmtools.node.logger import sendable
from lcmtools.node.replies import BYTES_A_SECOND, Key, Replies
from lcmtools.node.stopwatch import Stopwatch
from lcmtools.types.lcmtools_msgs import ServiceReply, ServiceRequest
from lcmtools.types.service import Service as Pair
from lcmtools.wire.datagram import MESSAGE_MAX

RETRY_PERIOD = 0.25
"""A request is sent again after this many seconds without an answer."""
_MAX_WAITING_REQUESTS = 100
_ENVELOPE_BYTES = 1000  # more than a reply has in addition to its payload

RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)
ServiceType = type[Pair[RequestT, ResponseT]]
"""A pair of message classes, like lcmtools.types.std_srvs.Trigger."""
ServiceCallback = Callable[[RequestT, ResponseT], ResponseT]
"""Called with the request and an empty response; returns the response."""


def request_channel(service: str) -> str:
    """Return the hidden channel of a service's requests."""
    return f"{service}/_request"


def reply_channel(service: str) -> str:
    """Return the hidden channel of a service's replies."""
    return f"{service}/_reply"


class Service(Generic[RequestT, ResponseT]):
    """Answers requests. Made by ``Node.create_service``.

    Attributes:
        name: The service's full name.
        service_type: Its pair of messages.
        stopwatch: Measures the time it takes to answer.
    """

    def __init__(
        self,
        bus: Bus,
        service_type: ServiceType[RequestT, ResponseT],
        name: str,
        callback: ServiceCallback[RequestT, ResponseT],
    ) -> None:
        self.name = name
        self.service_type = service_type
        self.callback = callback
        self.stopwatch = Stopwatch()
        self.on_ready: Callable[[], None] = lambda: None
        self._bus = bus
        self._lock = threading.Lock()
        self._waiting: list[ServiceRequest] = []
        self._unanswered: set[Key] = set()
        self._replies = Replies()
        self._calls = 0

    def receive(self, payload: bytes, _time: int) -> None:
        """Queue one request; called on the receiving thread. Other payloads are ignored."""
        try:
            request = decode(ServiceRequest, payload)
        except DecodeError:
            return
        with self._lock:
            # ignore a repetition of a request that still waits or is being executed
            if _key(request) in self._unanswered or len(self._waiting) >= _MAX_WAITING_REQUESTS:
                return
            self._unanswered.add(_key(request))
            self._waiting.append(request)
        self.on_ready()

    def pop_request(self) -> ServiceRequest | None:
        """Return the oldest waiting request; None if there is none."""
        with self._lock:
            return self._waiting.pop(0) if self._waiting else None

    def answer(self, request: ServiceRequest) -> BaseException | None:
        """Call the callback and send its response; return the failure, if any."""
        key = _key(request)
        failure: BaseException | None = None
        if key not in self._replies:
            payload, failure = self._reply(request)
            self._replies.add(key, payload)
        with self._lock:
            self._unanswered.discard(key)
        reply = self._replies.to_send(key, time.monotonic())
        try:
            if reply is not None:
                self._bus.publish(reply_channel(self.name), reply)
        except BusError as error:  # lost, as any message may be; the client repeats its request
            failure = failure or error
        return failure

    def endpoint(self) -> Endpoint:
        """Return the announced description."""
        watch = self.stopwatch
        end = _endpoint(self.name, Role.SERVICE, self.service_type.Request, self._calls)
        return end._replace(calls=watch.calls, busy=watch.busy(), longest=watch.longest())

    def _reply(self, request: ServiceRequest) -> tuple[bytes, BaseException | None]:
        self._calls += 1
        reply = ServiceReply()
        reply.client, reply.sequence = request.client, request.sequence
        reply.status = ServiceReply.OK
        failure: BaseException | None = None
        try:
            arguments = decode(self.service_type.Request, request.payload)
            response = self.callback(arguments, self.service_type.Response())
            reply.payload = self._encode(response)
        except LcmtoolsError as error:
            reply.status, reply.error, reply.payload = ServiceReply.FAILED, str(error), b""
        except Exception as error:  # noqa: BLE001 - a node outlives its callbacks' faults
            reply.status, reply.error, failure = ServiceReply.FAILED, repr(error), error
        reply.error = sendable(reply.error)
        return encode(reply), failure

    def _encode(self, response: object) -> bytes:
        expected = self.service_type.Response
        if not isinstance(response, expected):
            got = "None" if response is None else type(response).__name__
            hint = "; end it with: return response" if response is None else ""
            raise TypeError(f"the callback returned {got}, not {type_name(expected)}{hint}")
        payload = encode(response)
        if len(payload) > MESSAGE_MAX - _ENVELOPE_BYTES:
            raise LcmtoolsError(f"the response has {len(payload)} bytes, more than LCM carries")
        return payload


class Client(Generic[RequestT, ResponseT]):
    """Calls a service. Made by ``Node.create_client``.

    Attributes:
        name: The service's full name.
        service_type: Its pair of messages.
    """

    def __init__(self, bus: Bus, service_type: ServiceType[RequestT, ResponseT], name: str) -> None:
        self.name = name
        self.service_type = service_type
        self.is_destroyed = False
        self.is_interrupted: Callable[[], bool] = lambda: False
        self.before_call: Callable[[], None] = lambda: None
        self._bus = bus
        self._id = uuid.uuid4().hex
        self._sequence = 0
        self._changed = threading.Condition()
        self._replies: dict[int, ServiceReply | None] = {}  # by number; None while awaited

    @explained
    def call(self, request: RequestT, timeout: float = 3.0) -> ResponseT:
        """Send a request and wait for the response. May be called in a callback.

        Args:
            request: An instance of the service type's Request.
            timeout: Seconds to wait; meanwhile, the request is repeated.

        Raises:
            ServiceTimeout: No answer came in time.
            ServiceError: The server reports a failure, or answers with another message.
            ValueMismatch: The request is of another type, or a field's value does not fit.
            UsageError: The node was destroyed.
            BusOfParent: This is a forked process, and the client is its parent's.
        """
        if self.is_destroyed:
            raise UsageError(f"the client of {self.name} was destroyed with its node")
        kind = self.service_type.Request
        if not isinstance(request, kind):
            raise misfit(self.name, f"{self.service_type.__name__}.Request", kind, request)
        payload = encode(request)
        self.before_call()
        reply = self._exchange(payload, time.monotonic() + timeout)
        if reply is None and self.is_interrupted():
            raise ServiceError(f"{self.name} had not answered when the program had to end")
        if reply is None:
            what = f"{self.name} did not answer within {timeout:g} s"
            raise ServiceTimeout(what, "see whether its node runs: lcmtools node list")
        if reply.status != ServiceReply.OK:
            raise ServiceError(f"{self.name}: {reply.error or 'it failed, and does not say why'}")
        try:
            return decode(self.service_type.Response, reply.payload)
        except DecodeError as error:
            raise ServiceError(f"{self.name}: {error}") from error

    def receive(self, payload: bytes, _time: int) -> None:
        """Take a reply that is for this client; called on the receiving thread."""
        try:
            reply = decode(ServiceReply, payload)
        except DecodeError:
            return
        with self._changed:
            if reply.client == self._id and self._replies.get(reply.sequence, reply) is None:
                self._replies[reply.sequence] = reply
                self._changed.notify_all()

    def endpoint(self) -> Endpoint:
        """Return the announced description."""
        return _endpoint(self.name, Role.CLIENT, self.service_type.Request, self._sequence)

    def _exchange(self, request: bytes, deadline: float) -> ServiceReply | None:
        with self._changed:
            self._sequence = sequence = self._sequence + 1
            self._replies[sequence] = None
        envelope = ServiceRequest()
        envelope.client, envelope.sequence, envelope.payload = self._id, sequence, request
        payload = encode(envelope)
        patience = RETRY_PERIOD + len(payload) / BYTES_A_SECOND
        try:
            while (left := deadline - time.monotonic()) > 0 and not self.is_interrupted():
                self._bus.publish(request_channel(self.name), payload)
                self._bus.hand_over()
                with self._changed:
                    wait = min(left, patience)
                    if self._changed.wait_for(lambda: self._replies[sequence], timeout=wait):
                        break
        finally:
            with self._changed:
                reply = self._replies.pop(sequence)
        return reply


def _key(request: ServiceRequest) -> Key:
    return request.client, request.sequence


def _endpoint(name: str, role: Role, request: type[Message], calls: int) -> Endpoint:
    types = (type_name(request).removesuffix("_Request"),)
    return Endpoint(name, role, types, (fingerprint(request),), messages=calls)
