"""Services: a request channel and a reply channel, with an envelope of client and sequence number.

LCM has no calls. A client repeats its request until the reply with its sequence number arrives or
its timeout ends; the server executes each request once, and repeats its reply to a repeated one.
"""

import contextlib
import threading
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
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
from lcmtools.node.future import Future
from lcmtools.node.logger import sendable
from lcmtools.node.replies import BYTES_A_SECOND, Key, Replies
from lcmtools.node.stopwatch import Stopwatch
from lcmtools.types.lcmtools_msgs import ServiceReply, ServiceRequest
from lcmtools.types.service import Service as Pair
from lcmtools.wire.datagram import MESSAGE_MAX

RETRY_PERIOD = 0.25
"""A request is sent again after this many seconds without an answer."""
_LONGEST_PATIENCE = 4.0
"""A request of ``call_async`` is sent again more and more seldom, at last after so many seconds."""
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


@dataclass(slots=True)
class _UnderWay(Generic[ResponseT]):
    """A request of ``call_async`` that has no answer."""

    future: Future[ResponseT]
    payload: bytes
    due: float  # [s] to be sent again
    patience: float  # [s] that passed before


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
        self.server: Callable[..., str] = lambda *_: ""
        """Returns the service's node if it is here and one of these threads spins it; else ""."""
        self.on_spin: Callable[[Callable[[], None]], None] = lambda function: function()
        """Lets the thread that spins call a function."""
        self._bus = bus
        self._id = uuid.uuid4().hex
        self._sequence = 0
        self._changed = threading.Condition()
        self._replies: dict[int, ServiceReply | None] = {}  # by number; None while awaited
        self._under_way: dict[int, _UnderWay[ResponseT]] = {}
        self._repeater: threading.Thread | None = None

    @explained
    def call(self, request: RequestT, timeout: float = 3.0) -> ResponseT:
        """Send a request and wait for the response. May be called in a callback.

        Args:
            request: An instance of the service type's Request.
            timeout: Seconds to wait; meanwhile, the request is repeated.

        Raises:
            ServiceTimeout: No answer came in time.
            ServiceError: The server reports a failure, or answers with another message; or it is a
                callback's own node, which cannot answer before the callback has ended.
            ValueMismatch: The request is of another type, or a field's value does not fit.
            UsageError: The node was destroyed.
            BusOfParent: This is a forked process, and the client is its parent's.
        """
        if node := self.server(threading.get_ident()):
            what = f"{self.name} cannot answer during this callback: {node} has it, on this thread"
            raise ServiceError(what, "use call_async, or call the function that answers it")
        sequence, payload = self._numbered(request)
        reply = self._exchange(sequence, payload, time.monotonic() + timeout)
        if reply is None and self.is_interrupted():
            raise ServiceError(f"{self.name} had not answered when the program had to end")
        if reply is None:
            what = f"{self.name} did not answer within {timeout:g} s"
            if node := self.server(None):
                what += f": its node {node} is in this program, and no other thread spins it"
                raise ServiceTimeout(what, "use call_async, or call spin_in_background before")
            raise ServiceTimeout(what, "see whether its node runs: lcmtools node list")
        return self._response(reply)

    @explained
    def call_async(self, request: RequestT) -> Future[ResponseT]:
        """Send a request, which is repeated until it is answered; return a future of the response.

        The future is done while its node spins: ``lcmtools.spin_until_future_complete``. Its
        ``result`` is the response, or raises ServiceError if the server reports a failure.

        Raises:
            ValueMismatch: The request is of another type, or a field's value does not fit.
            UsageError: The node was destroyed.
            BusOfParent: This is a forked process, and the client is its parent's.
        """
        sequence, payload = self._numbered(request)
        future: Future[ResponseT] = Future()
        with self._changed:
            patience = _patience(payload)
            due = time.monotonic() + patience
            self._under_way[sequence] = _UnderWay(future, payload, due, patience)
            if self._repeater is None:
                self._repeater = threading.Thread(target=self._repeat, daemon=True)
                self._repeater.start()
        self._bus.publish(request_channel(self.name), payload)
        return future

    def receive(self, payload: bytes, _time: int) -> None:
        """Take a reply that is for this client; called on the receiving thread."""
        try:
            reply = decode(ServiceReply, payload)
        except DecodeError:
            return
        with self._changed:
            if reply.client != self._id:
                return
            if call := self._under_way.pop(reply.sequence, None):
                self.on_spin(partial(self._complete, call.future, reply))
            elif self._replies.get(reply.sequence, reply) is None:
                self._replies[reply.sequence] = reply
                self._changed.notify_all()

    def endpoint(self) -> Endpoint:
        """Return the announced description."""
        return _endpoint(self.name, Role.CLIENT, self.service_type.Request, self._sequence)

    def _numbered(self, request: RequestT) -> tuple[int, bytes]:
        """Return the number and the message of the next request."""
        if self.is_destroyed:
            raise UsageError(f"the client of {self.name} was destroyed with its node")
        kind = self.service_type.Request
        if not isinstance(request, kind):
            raise misfit(self.name, f"{self.service_type.__name__}.Request", kind, request)
        envelope = ServiceRequest()
        envelope.client, envelope.payload = self._id, encode(request)
        self.before_call()
        with self._changed:
            self._sequence = envelope.sequence = self._sequence + 1
        return envelope.sequence, encode(envelope)

    def _response(self, reply: ServiceReply) -> ResponseT:
        if reply.status != ServiceReply.OK:
            raise ServiceError(f"{self.name}: {reply.error or 'it failed, and does not say why'}")
        try:
            return decode(self.service_type.Response, reply.payload)
        except DecodeError as error:
            raise ServiceError(f"{self.name}: {error}") from error

    def _complete(self, future: Future[ResponseT], reply: ServiceReply) -> None:
        try:
            response = self._response(reply)
        except ServiceError as error:
            future.set_exception(error)
        else:
            future.set_result(response)

    def _exchange(self, sequence: int, payload: bytes, deadline: float) -> ServiceReply | None:
        with self._changed:
            self._replies[sequence] = None
        try:
            while (left := deadline - time.monotonic()) > 0 and not self.is_interrupted():
                self._bus.publish(request_channel(self.name), payload)
                self._bus.hand_over()
                with self._changed:
                    wait = min(left, _patience(payload))
                    if self._changed.wait_for(lambda: self._replies[sequence], timeout=wait):
                        break
        finally:
            with self._changed:
                reply = self._replies.pop(sequence)
        return reply

    def _repeat(self) -> None:
        """Send requests again while there are some without an answer, on a thread of its own."""
        while True:
            time.sleep(RETRY_PERIOD)
            now = time.monotonic()
            with self._changed:
                calls = {n: one for n, one in self._under_way.items() if not one.future.done()}
                self._under_way = calls
                if not calls or self.is_destroyed or self.is_interrupted():
                    self._repeater = None
                    return
                due = [one for one in calls.values() if now >= one.due]
            for one in due:
                one.patience = min(2 * one.patience, _LONGEST_PATIENCE)
                one.due = now + one.patience
                with contextlib.suppress(BusError):  # lost, as any message may be
                    self._bus.publish(request_channel(self.name), one.payload)


def _patience(payload: bytes) -> float:
    """Return the time after which a request without an answer is sent again [s]."""
    return RETRY_PERIOD + len(payload) / BYTES_A_SECOND


def _key(request: ServiceRequest) -> Key:
    return request.client, request.sequence


def _endpoint(name: str, role: Role, request: type[Message], calls: int) -> Endpoint:
    types = (type_name(request).removesuffix("_Request"),)
    return Endpoint(name, role, types, (fingerprint(request),), messages=calls)
