"""The protocol of announcements: its hidden channels and the messages on them.

Every node publishes a lcmtools_msgs/Announcement on NODE_CHANNEL once a second, at once on a change
or on a lcmtools_msgs/Probe on PROBE_CHANNEL, and, with the state LEAVING, when it ends. A
lcmtools_msgs/Shutdown on SHUTDOWN_CHANNEL requests that a node's program end. Relays pass
announcements on to other buses as lcmtools_msgs/RemoteAnnouncement, on NODE_CHANNEL too, and
report on RELAY_CHANNEL.

These messages are frozen; what may grow in them is appendable (``messages/appendable``), so that
programs of different versions see each other. docs/protocol.md describes all of it.
"""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import lru_cache
from typing import NamedTuple, TypeVar

from lcmtools import __version__
from lcmtools.bounded import BoundedDict
from lcmtools.errors import DecodeError, InvalidName
from lcmtools.graph.model import (
    STALE_AFTER,
    CallbackError,
    Endpoint,
    FullLine,
    NodeInfo,
    RelayStep,
    Role,
    Traffic,
)
from lcmtools.messages.appendable import (
    Binding,
    appendables,
    decode_appendable,
    encode_appendable,
)
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Message, fingerprint
from lcmtools.names import check_length, check_node
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.wire.packet import Sender

NODE_CHANNEL = "/_lcmtools/node"
PROBE_CHANNEL = "/_lcmtools/probe"
SHUTDOWN_CHANNEL = "/_lcmtools/shutdown"
RELAY_CHANNEL = "/_lcmtools/relay"
PROTOCOL_CHANNELS = frozenset({NODE_CHANNEL, PROBE_CHANNEL, SHUTDOWN_CHANNEL, RELAY_CHANNEL})
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

_MOST_ERRORS = 5
MOST_OBSERVED = 200
"""The most channels of plain LCM programs that a relay tells of: they take some kB each second."""
_MOST_LINES = 20
_MOST_ENDPOINTS, _MOST_OF_ENDPOINT = 1 << 13, 1000  # that are kept decoded; bytes of one

_FINGERPRINT = fingerprint(msgs.Announcement).to_bytes(8, "big")
_NAME_OFFSET = 16  # in an announcement: after fingerprint, length of the details and version
_BEFORE_ID_BYTES = 12  # pid and start time
_STATE_BYTES = 1
_REMOTE = fingerprint(msgs.RemoteAnnouncement).to_bytes(8, "big")
_WRAPPED_OFFSET = 16  # after the fingerprint and two length fields
_REVISION_BYTES = 8


class Announcement(NamedTuple):
    """A node's announcement of itself."""

    node: NodeInfo
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
    return encode(_PROBE.message(probe))


def decode_probe(payload: bytes) -> Probe | None:
    """Return the probe in a payload; None if there is none."""
    message = _decoded(msgs.Probe, payload)
    return _PROBE.value(message) if message else None


def encode_shutdown(request: Shutdown) -> bytes:
    """Return the payload of a request to end."""
    return encode(_SHUTDOWN.message(request))


def decode_shutdown(payload: bytes) -> Shutdown | None:
    """Return the request to end in a payload; None if there is none."""
    message = _decoded(msgs.Shutdown, payload)
    return _SHUTDOWN.value(message) if message else None


def encode_announcement(announcement: Announcement) -> bytes:
    """Return the payload of an announcement."""
    node = announcement.node
    message = _HEAD.message(
        node,
        state=msgs.Announcement.LEAVING if announcement.leaving else msgs.Announcement.ALIVE,
        revision=_revision(node),
        answers=announcement.answers,
        details=_encode_details(node) if node.has_details else b"",
    )
    return _wrapped(encode(message), node.path) if node.path else encode(message)


def decode_announcement(payload: bytes) -> Announcement | None:
    """Return the announcement in a payload, of whatever version; None if there is none.

    A node whose details cannot be read, or are too large, has none (``Node.has_details``).
    """
    if payload.startswith(_REMOTE):
        return _decode_remote(payload)
    message = _decoded(msgs.Announcement, payload)
    if message is None or not _is_node_name(message.name):
        return None
    if len(payload) - len(message.details) > _MOST_OF_HEAD:
        return None
    node = _HEAD.value(message)
    is_leaving = message.state == msgs.Announcement.LEAVING
    return Announcement(_with_details(node, message.details), is_leaving, message.answers)


def head_of(payload: bytes) -> Head:
    """Return the head of an announcement, read without decoding it."""
    if payload.startswith(_REMOTE):
        end = _WRAPPED_OFFSET + int.from_bytes(payload[8:12], "big")
        inner = head_of(payload[_WRAPPED_OFFSET:end])
        return Head(_REMOTE + inner.identity, inner.revision + payload[end:])
    if not payload.startswith(_FINGERPRINT):
        return Head(b"", b"")
    start = end = _NAME_OFFSET
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


def _encode_details(node: NodeInfo) -> bytes:
    details = _DETAILS.message(node)
    if node.observed or node.full_lines:
        publishers = appendables(map(_seen_message, node.observed))
        (details.observed,) = appendables([_OBSERVED.message(node, publishers=publishers)])
    return encode_appendable(details)


def _with_details(node: NodeInfo, data: bytes) -> NodeInfo:
    """Return a node with its details, without endpoints of unknown roles."""
    if not data or len(data) > _MOST_DETAILS:  # a relay could not read them, or it floods the bus
        return node._replace(has_details=False)
    try:
        details = decode_appendable(msgs.NodeDetails, data)
        heard = decode_appendable(msgs.Observed, details.observed.data)
        observed = [_observed(one.data, node.name) for one in heard.publishers[:MOST_OBSERVED]]
        node = node._replace(**_DETAILS.values(details), **_OBSERVED.values(heard))
    except DecodeError:
        return node._replace(has_details=False)
    return node._replace(observed=tuple(filter(None, observed)))


def _is_node_name(name: str) -> bool:
    with suppress(InvalidName, ValueError):
        check_node(check_length(name))
        return True
    return False


def _wrapped(announcement: bytes, path: Iterable[RelayStep]) -> bytes:
    message = msgs.RemoteAnnouncement()
    message.announcement, message.steps = announcement, _STEP.appendables(path)
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
        path = _STEP.all(message.steps)
    except DecodeError:
        return None
    if announcement is None:
        return None
    return announcement._replace(node=announcement.node._replace(path=path, ports=()))


def _revision(node: NodeInfo) -> int:
    """Return a number that changes with everything in a node except its counters."""
    plain = [(*end.key, end.fingerprints, end.depth, end.latched) for end in node.endpoints]
    errors = sorted((error.callback, error.exception, error.place) for error in node.errors)
    # hashes text, because different numbers may have equal hashes; only its own process compares
    observed = sorted((x.channel, str(x.sender), x.fingerprints, x.types) for x in node.observed)
    return hash(repr((node.command, node.tool, node.ports, plain, errors, observed)))


def _line_message(line: FullLine) -> msgs.FullLine:
    passing = dict(line.passing)
    return msgs.FullLine(line.to, line.dropped, [*passing], [*passing.values()])


def _full_line(data: bytes) -> FullLine:
    message = decode_appendable(msgs.FullLine, data)
    passing = zip(message.topics, message.rates, strict=False)
    return FullLine(message.to, message.dropped, tuple(passing))


def _seen_message(seen: Traffic) -> msgs.ObservedPublisher:
    place = {"host": seen.sender.address, "port": seen.sender.port} if seen.sender else {}
    return _SEEN.message(seen, **place)


def _observed(data: bytes, observer: str) -> Traffic | None:
    """Return what a relay or server has observed; None if its topic is no channel.

    The sender has a name, so that nothing of this computer is taken for it.
    """
    message = decode_appendable(msgs.ObservedPublisher, data)
    host = message.host or "unknown"
    place = f"{host}:{message.port}" if message.port else host
    name = f"{place}, on {message.bus}" if message.bus else place
    with suppress(InvalidName, ValueError):
        sender = Sender(message.host, message.port, name)
        return _SEEN.value(message, sender=sender, observer=observer)
    return None


def _endpoint(data: bytes) -> Endpoint | None:
    """Return an announced endpoint; None if its role is unknown or its topic is no channel.

    Most endpoints of a node are the same in its next announcement, byte for byte.
    """
    return (_known_endpoint if len(data) <= _MOST_OF_ENDPOINT else _decode_endpoint)(data)


def _decode_endpoint(data: bytes) -> Endpoint | None:
    with suppress(InvalidName, ValueError):
        return _ENDPOINT.decode(data)
    return None


_known_endpoint = lru_cache(_MOST_ENDPOINTS)(_decode_endpoint)


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


def _signed(fingerprints: Iterable[int]) -> list[int]:
    return [value - (1 << 64) if value >= 1 << 63 else value for value in fingerprints]


_CHANNEL, _COMMAND, _FINGERPRINTS = (str, check_length), (_sendable, str), (_signed, _unsigned)
_PROBE = Binding(msgs.Probe, Probe)
_SHUTDOWN = Binding(msgs.Shutdown, Shutdown, requester=_COMMAND)
_STEP = Binding(msgs.RelayStep, RelayStep)
_ERROR = Binding(msgs.CallbackError, CallbackError)
_ENDPOINT = Binding(
    msgs.Endpoint, Endpoint, topic=_CHANNEL, role=(int, Role), fingerprints=_FINGERPRINTS
)
_SEEN = Binding(msgs.ObservedPublisher, Traffic, channel=_CHANNEL, fingerprints=_FINGERPRINTS)
_HEAD = Binding(msgs.Announcement, NodeInfo, command=_COMMAND, tool=(bool, bool))
_DETAILS = Binding(
    msgs.NodeDetails,
    NodeInfo,
    without=("observed",),
    endpoints=(
        _ENDPOINT.appendables,
        lambda ones: tuple(filter(None, (_endpoint(one.data) for one in ones))),
    ),
    errors=(lambda errors: _ERROR.appendables(errors[-_MOST_ERRORS:]), _ERROR.all),
)
_OBSERVED = Binding(
    msgs.Observed,
    NodeInfo,
    full_lines=(
        lambda lines: appendables(map(_line_message, lines)),
        lambda ones: tuple(_full_line(one.data) for one in ones[:_MOST_LINES]),
    ),
)
