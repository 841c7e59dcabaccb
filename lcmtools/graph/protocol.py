"""The protocol of announcements: its hidden channels and the messages on them.

Every node publishes a lcmtools_msgs/Announcement on NODE_CHANNEL once a second, at once on a change
or on a lcmtools_msgs/Probe on PROBE_CHANNEL, and, with the state LEAVING, when it ends. A
lcmtools_msgs/Shutdown on SHUTDOWN_CHANNEL requests that a node's program end. Relays pass
announcements on to other buses as lcmtools_msgs/RemoteAnnouncement, on NODE_CHANNEL too, and
report on RELAY_CHANNEL.

These messages are frozen; what may grow in them is appendable (``messages/appendable``), so that
programs of different versions see each other. docs/protocol.md describes all of it.
"""

import struct
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar, cast

from lcmtools import __version__
from lcmtools.bounded import BoundedDict
from lcmtools.errors import DecodeError, InvalidName
from lcmtools.graph.model import (
    STALE_AFTER,
    CallbackError,
    Endpoint,
    FullLine,
    Node,
    RelayStep,
    Role,
    Traffic,
)
from lcmtools.messages.appendable import appendables, decode_appendable, encode_appendable
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.coder import coder
from lcmtools.messages.registry import Message, fingerprint
from lcmtools.messages.rows import Cursor, Malformed
from lcmtools.names import check_length, check_node
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.wire.packet import Sender

NODE_CHANNEL = "/_lcmtools/node"
PROBE_CHANNEL = "/_lcmtools/probe"
SHUTDOWN_CHANNEL = "/_lcmtools/shutdown"
RELAY_CHANNEL = "/_lcmtools/relay"
TALK_CHANNELS = frozenset({NODE_CHANNEL, PROBE_CHANNEL, SHUTDOWN_CHANNEL, RELAY_CHANNEL})
"""The hidden channels of the protocol, which are not topics."""
SOFTWARE = f"lcmtools {__version__}"
"""The name and version of this library, as its nodes announce it."""
PERIOD = 1.0
"""Seconds between two announcements of a node that does not change."""
ANSWER_SPREAD = 0.01
"""Nodes spread their answers to a probe for all over this time [s]."""

_MOST_RETAINED, _MOST_RETAINED_BYTES = 2000, 8 << 20  # announcements
MOST_OF_COMMAND = 1000
"""The most characters of a command line that are announced."""

M = TypeVar("M", bound=Message)
_MOST_DETAILS, _MOST_OF_HEAD = 512 << 10, 64 << 10
"""The most bytes of an announcement's details, of 3500 endpoints, and of all else in it."""

_COUNTERS = (
    "messages",
    "bytes",
    "drops",
    "last_time",
    "calls",
    "busy",
    "longest",
    "rate",
    "incomplete",
)
_OF_ENDPOINT = ("group", "depth", "latched", *_COUNTERS)
_OF_HEAD = ("version", "name", "id", "host", "pid", "start_time", "software", "sent")

_OF_ERROR = ("callback", "exception", "message", "place", "count", "last_time")
_MOST_ERRORS = 5
MOST_OBSERVED = 200
"""The most channels of plain LCM programs that a relay tells of: they take some kB each second."""
_MOST_LINES = 20
_OF_OBSERVED = ("channel", "messages", "bytes", "first_time", "last_time", "bus")
_MOST_ENDPOINTS, _MOST_OF_ENDPOINT = 1 << 13, 1000  # that are kept decoded; bytes of one

_FINGERPRINT = fingerprint(msgs.Announcement).to_bytes(8, "big")
_VERSION_0 = 0x7AD407B1A45D0859.to_bytes(8, "big")  # the announcement before the first version
_NAME_OFFSETS = {  # in an announcement
    _FINGERPRINT: 16,  # after the fingerprint, the length of the details and the version
    _VERSION_0: 20,  # after the fingerprint and three lengths
}
_BEFORE_ID_BYTES = 12  # pid and start time
_STATE_BYTES = 1
_REMOTE = fingerprint(msgs.RemoteAnnouncement).to_bytes(8, "big")
_WRAPPED_OFFSET = 16  # after the fingerprint and two length fields
_REVISION_BYTES = 8


class Announcement(NamedTuple):
    """A node's announcement of itself."""

    node: Node
    leaving: bool = False  # True if the node is ending
    answers: int = 0  # the nonce of the answered probe; 0 for none

    def sent_at(self, time: int) -> "Announcement":
        """Return the same announcement as sent at a time [ns since 1970]."""
        return self._replace(node=self.node._replace(sent=time))


class Probe(NamedTuple):
    """A request to nodes to announce themselves."""

    target: str = ""  # a node's full name; "" for every node
    nonce: int = 0  # repeated in the answer


class Shutdown(NamedTuple):
    """A request to a node's program to end, as by SIGTERM."""

    target: str  # the node's id
    nonce: int = 0  # repeated in an announcement that acknowledges the request
    requester: str = ""  # for the node's log


class Head(NamedTuple):
    """The head of an announcement, read without decoding it; empty if there is none."""

    identity: bytes  # the same in all announcements of one node but its goodbye, and in no others
    revision: bytes  # the same until more of the node changes than its counters and its clock


def encode_probe(probe: Probe) -> bytes:
    """Return the payload of a probe."""
    return encode(_filled(msgs.Probe(), probe, ("target", "nonce")))


def decode_probe(payload: bytes) -> Probe | None:
    """Return the probe in a payload; None if there is none."""
    message = _decoded(msgs.Probe, payload)
    return Probe(message.target, message.nonce) if message else None


def encode_shutdown(request: Shutdown) -> bytes:
    """Return the payload of a request to end."""
    message = _filled(msgs.Shutdown(), request, ("target", "nonce"))
    message.requester = _sendable(request.requester)
    return encode(message)


def decode_shutdown(payload: bytes) -> Shutdown | None:
    """Return the request to end in a payload; None if there is none."""
    message = _decoded(msgs.Shutdown, payload)
    return Shutdown(message.target, message.nonce, message.requester) if message else None


def encode_announcement(announcement: Announcement) -> bytes:
    """Return the payload of an announcement."""
    node = announcement.node
    message = _filled(msgs.Announcement(), node, _OF_HEAD)
    message.command, message.tool = _sendable(node.command), node.tool
    message.state = msgs.Announcement.LEAVING if announcement.leaving else msgs.Announcement.ALIVE
    message.revision = _revision(node)
    message.answers = announcement.answers
    message.details = _encode_details(node) if node.has_details else b""
    return _wrapped(encode(message), node.path) if node.path else encode(message)


def decode_announcement(payload: bytes) -> Announcement | None:
    """Return the announcement in a payload, of whatever version; None if there is none.

    A node whose details cannot be read, or are too large, has none (``Node.has_details``).
    """
    if payload.startswith(_REMOTE):
        return _decode_remote(payload)
    if payload.startswith(_VERSION_0):
        return _decode_version_0(payload)
    message = _decoded(msgs.Announcement, payload)
    if message is None or not _is_node_name(message.name):
        return None
    if len(payload) - len(message.details) > _MOST_OF_HEAD:
        return None
    node = Node(**_values(message, (*_OF_HEAD, "command")), tool=bool(message.tool))
    is_leaving = message.state == msgs.Announcement.LEAVING
    return Announcement(_with_details(node, message.details), is_leaving, message.answers)


def head_of(payload: bytes) -> Head:
    """Return the head of an announcement, read without decoding it."""
    if payload.startswith(_REMOTE):
        end = _WRAPPED_OFFSET + int.from_bytes(payload[8:12], "big")
        inner = head_of(payload[_WRAPPED_OFFSET:end])
        return Head(_REMOTE + inner.identity, inner.revision + payload[end:])
    start = end = _NAME_OFFSETS.get(payload[:8], 0)
    if not start:
        return Head(b"", b"")
    for fixed_bytes in (0, _BEFORE_ID_BYTES, _STATE_BYTES):  # after name, after host, after id
        end += 4 + int.from_bytes(payload[end : end + 4], "big") + fixed_bytes
    return Head(payload[start:end], payload[end : end + _REVISION_BYTES])


class Retained:
    """The latest announcements of a program's nodes, for programs that ask for them later."""

    def __init__(self) -> None:
        self._latest = BoundedDict[bytes, tuple[bytes, float]](_MOST_RETAINED, _MOST_RETAINED_BYTES)

    def keep(self, payload: bytes, now: float) -> None:
        """Keep an announcement in place of the node's earlier one; forget a node that leaves."""
        identity = head_of(payload).identity
        node, state = identity[:-_STATE_BYTES], identity[-_STATE_BYTES:]
        if state == bytes([msgs.Announcement.LEAVING]):
            self._latest.pop(node, None)
        else:
            self._latest.put(node, (payload, now), len(payload))

    def payloads(self, now: float) -> Iterator[bytes]:
        """Yield the announcements of the last seconds, without their times of sending.

        Times are monotonic [s].
        """
        for payload, kept in tuple(self._latest.values()):
            if (now - kept) * 1e9 < STALE_AFTER:
                yield _without_time(payload)


def _without_time(payload: bytes) -> bytes:
    """Return an announcement without the time of sending and the answer, its details unread."""
    if payload.startswith(_REMOTE):
        remote = decode(msgs.RemoteAnnouncement, payload)
        remote.announcement = _without_time(remote.announcement)
        return encode(remote)
    if not payload.startswith(_FINGERPRINT):
        return payload
    message = decode(msgs.Announcement, payload)
    message.sent = message.answers = 0
    return encode(message)


def _encode_details(node: Node) -> bytes:
    details = msgs.NodeDetails()
    details.ports, details.busy = list(node.ports), node.busy
    details.overflows = node.overflows
    details.endpoints = appendables(map(_endpoint_message, node.endpoints))
    newest = node.errors[-_MOST_ERRORS:]
    details.errors = appendables(_filled(msgs.CallbackError(), e, _OF_ERROR) for e in newest)
    details.pid_namespace = node.pid_namespace
    if node.observed or node.full_lines:
        observed = msgs.Observed()
        observed.publishers = appendables(map(_observed_message, node.observed))
        observed.full_lines = appendables(map(_line_message, node.full_lines))
        (details.observed,) = appendables([observed])
    return encode_appendable(details)


def _with_details(node: Node, data: bytes) -> Node:
    """Return a node with its details, without endpoints of unknown roles."""
    if not data or len(data) > _MOST_DETAILS:  # a relay could not read them, or it floods the bus
        return node._replace(has_details=False)
    try:
        details = decode_appendable(msgs.NodeDetails, data)
        endpoints = [_endpoint(one.data) for one in details.endpoints]
        errors = [decode_appendable(msgs.CallbackError, one.data) for one in details.errors]
        heard = decode_appendable(msgs.Observed, details.observed.data)
        observed = [_observed(one.data, node.name) for one in heard.publishers[:MOST_OBSERVED]]
        lines = [_full_line(one.data) for one in heard.full_lines[:_MOST_LINES]]
    except DecodeError:
        return node._replace(has_details=False)
    return node._replace(
        ports=tuple(details.ports),
        endpoints=tuple(filter(None, endpoints)),
        busy=details.busy,
        overflows=details.overflows,
        errors=tuple(CallbackError(**_values(error, _OF_ERROR)) for error in errors),
        pid_namespace=details.pid_namespace,
        observed=tuple(filter(None, observed)),
        full_lines=tuple(lines),
    )


def _decode_version_0(payload: bytes) -> Announcement | None:
    """Return the head of an announcement as it was before the first version."""
    from lcmtools.types.std_msgs import String  # late: only for such a node

    def text() -> str:
        return cast("String", coder(String).read(cursor)).data

    if len(payload) > _MOST_DETAILS:
        return None
    cursor = Cursor(payload, _NAME_OFFSETS[_VERSION_0])
    try:
        name, host = text(), text()
        pid, start_time = struct.unpack_from(">iq", payload, cursor.advance(12, "pid"))
        id_ = text()
        state, _, tool = struct.unpack_from(">bq?", payload, cursor.advance(10, "state"))
        command = text()
        (answers,) = struct.unpack_from(">q", payload, cursor.advance(8, "answers"))
    except Malformed:
        return None
    if not _is_node_name(name):
        return None
    node = Node(name, id_, host, pid, start_time, command, tool, version=0, has_details=False)
    return Announcement(node, state == msgs.Announcement.LEAVING, answers)


def _is_node_name(name: str) -> bool:
    with suppress(InvalidName, ValueError):
        check_node(check_length(name))
        return True
    return False


def _wrapped(announcement: bytes, path: Iterable[RelayStep]) -> bytes:
    message = msgs.RemoteAnnouncement()
    message.announcement = announcement
    message.steps = appendables(_filled(msgs.RelayStep(), step, RelayStep._fields) for step in path)
    return encode(message)


def _decode_remote(payload: bytes) -> Announcement | None:
    if len(payload) > _MOST_DETAILS + _MOST_OF_HEAD:
        return None
    message = _decoded(msgs.RemoteAnnouncement, payload)
    inner = message.announcement if message else b""
    if message is None or not message.steps or inner.startswith(_REMOTE):
        return None
    announcement = decode_announcement(inner)
    try:
        steps = [decode_appendable(msgs.RelayStep, step.data) for step in message.steps]
    except DecodeError:
        return None
    if announcement is None:
        return None
    path = tuple(RelayStep(**_values(step, RelayStep._fields)) for step in steps)
    return announcement._replace(node=announcement.node._replace(path=path, ports=()))


def _revision(node: Node) -> int:
    """Return a number that changes with everything in a node except its counters."""
    zeros: dict[str, Any] = dict.fromkeys(_COUNTERS, 0)
    plain = [endpoint._replace(**zeros) for endpoint in node.endpoints]
    errors = sorted((error.callback, error.exception, error.place) for error in node.errors)
    # hashes text, because different numbers may have equal hashes; only its own process compares
    observed = sorted((x.channel, str(x.sender), x.fingerprints, x.types) for x in node.observed)
    return hash(repr((node.command, node.tool, node.ports, plain, errors, observed)))


def _endpoint_message(endpoint: Endpoint) -> msgs.Endpoint:
    message = _filled(msgs.Endpoint(), endpoint, _OF_ENDPOINT)
    message.topic, message.role = endpoint.topic, endpoint.role
    message.types = list(endpoint.types)
    message.fingerprints = [_signed(value) for value in endpoint.fingerprints]
    return message


def _line_message(line: FullLine) -> msgs.FullLine:
    message = _filled(msgs.FullLine(), line, ("to", "dropped"))
    message.topics = [topic for topic, _ in line.passing]
    message.rates = [rate for _, rate in line.passing]
    return message


def _full_line(data: bytes) -> FullLine:
    message = decode_appendable(msgs.FullLine, data)
    passing = zip(message.topics, message.rates, strict=False)
    return FullLine(message.to, message.dropped, tuple(passing))


def _observed_message(seen: Traffic) -> msgs.ObservedPublisher:
    message = _filled(msgs.ObservedPublisher(), seen, _OF_OBSERVED)
    if seen.sender:
        message.host, message.port = seen.sender.address, seen.sender.port
    message.types = list(seen.types)
    message.fingerprints = [_signed(value) for value in seen.fingerprints]
    return message


def _observed(data: bytes, observer: str) -> Traffic | None:
    """Return what a relay or server has observed; None if its topic is no channel.

    The sender has a name, so that nothing of this computer is taken for it.
    """
    message = decode_appendable(msgs.ObservedPublisher, data)
    with suppress(InvalidName, ValueError):
        host = message.host or "unknown"
        place = f"{host}:{message.port}" if message.port else host
        name = f"{place}, on {message.bus}" if message.bus else place
        return Traffic(
            **{**_values(message, _OF_OBSERVED), "channel": check_length(message.channel)},
            sender=Sender(message.host, message.port, name),
            types=tuple(message.types),
            fingerprints=_unsigned(message.fingerprints),
            observer=observer,
        )
    return None


def _endpoint(data: bytes) -> Endpoint | None:
    """Return an announced endpoint; None if its role is unknown or its topic is no channel.

    Most endpoints of a node are the same in its next announcement, byte for byte.
    """
    return (_known_endpoint if len(data) <= _MOST_OF_ENDPOINT else _decode_endpoint)(data)


def _decode_endpoint(data: bytes) -> Endpoint | None:
    message = decode_appendable(msgs.Endpoint, data)
    try:
        return Endpoint(
            **_values(message, _OF_ENDPOINT),
            topic=check_length(message.topic),
            role=Role(message.role),
            types=tuple(message.types),
            fingerprints=_unsigned(message.fingerprints),
        )
    except (InvalidName, ValueError):
        return None


_known_endpoint = lru_cache(_MOST_ENDPOINTS)(_decode_endpoint)


def _filled(message: M, source: object, names: Iterable[str]) -> M:
    """Return the message with the values of the source's attributes of the same names."""
    for name, value in _values(source, names).items():
        setattr(message, name, value)
    return message


def _values(source: object, names: Iterable[str]) -> dict[str, Any]:
    return {name: getattr(source, name) for name in names}


def _decoded(cls: type[M], payload: bytes) -> M | None:
    try:
        return decode(cls, payload)
    except DecodeError:
        return None


def _sendable(command: str) -> str:
    """Return a command line that can be sent each second: it may be very long, or not UTF-8."""
    return command[:MOST_OF_COMMAND].encode("utf-8", "replace").decode()


def _unsigned(fingerprints: Iterable[int]) -> tuple[int, ...]:
    return tuple(value & 0xFFFFFFFFFFFFFFFF for value in fingerprints)


def _signed(fingerprint: int) -> int:
    return fingerprint - (1 << 64) if fingerprint >= 1 << 63 else fingerprint
