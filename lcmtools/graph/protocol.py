"""The protocol of announcements: its hidden channels and the messages on them.

Every node publishes a lcmtools_msgs/Announcement on NODE_CHANNEL once a second, at once on a
change, at once on a lcmtools_msgs/Probe on PROBE_CHANNEL, and one with the state LEAVING when it
ends. A lcmtools_msgs/Shutdown on SHUTDOWN_CHANNEL requests that a node's program end.
"""

from dataclasses import dataclass, replace
from hashlib import blake2b
from typing import NamedTuple

from lcmtools.errors import DecodeError, InvalidName
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import fingerprint
from lcmtools.names import check_length, check_node
from lcmtools.types import lcmtools_msgs as msgs

NODE_CHANNEL = "/_lcmtools/node"
PROBE_CHANNEL = "/_lcmtools/probe"
SHUTDOWN_CHANNEL = "/_lcmtools/shutdown"
TALK_CHANNELS = frozenset({NODE_CHANNEL, PROBE_CHANNEL, SHUTDOWN_CHANNEL})
"""The hidden channels of the protocol, which are not topics."""
PERIOD = 1.0
"""Seconds between two announcements of a node at rest."""
ANSWER_SPREAD = 0.01
"""Nodes answer a probe to all within so many seconds, not all in the same instant."""

MOST_OF_COMMAND = 1000
"""Characters of a command line that are announced."""

_FINGERPRINT = fingerprint(msgs.Announcement).to_bytes(8, "big")
_NAME_OFFSET = 16  # after the fingerprint and two length fields
_BEFORE_ID_BYTES = 12  # pid and start time
_STATE_BYTES = 1
_REVISION_BYTES = 8


@dataclass(frozen=True, slots=True)
class Announcement:
    """A node's announcement of itself."""

    node: Node
    leaving: bool = False  # it is ending
    answers: int = 0  # the nonce of the probe that this answers; 0 for none

    def sent_at(self, time: int) -> "Announcement":
        """The same, as it is sent at a time [ns since 1970]."""
        return replace(self, node=replace(self.node, sent=time))


@dataclass(frozen=True, slots=True)
class Probe:
    """A request to nodes to announce themselves."""

    target: str = ""  # a node's full name; "" for every node
    nonce: int = 0  # comes back in the answer


@dataclass(frozen=True, slots=True)
class Shutdown:
    """A request to a node's program to end, as by SIGTERM."""

    target: str  # the node's id
    nonce: int = 0  # comes back in an announcement, which acknowledges the request
    requester: str = ""  # for the node's log


class Head(NamedTuple):
    """The head of an announcement, read without decoding it; empty where there is none.

    Attributes:
        identity: Equal in all announcements of one node but its goodbye, and in no others.
        revision: Equal until more of the node changes than its counters and its clock.
    """

    identity: bytes
    revision: bytes


def encode_probe(probe: Probe) -> bytes:
    """Return the payload of a probe."""
    message = msgs.Probe()
    message.target, message.nonce = probe.target, probe.nonce
    return encode(message)


def decode_probe(payload: bytes) -> Probe | None:
    """Return the probe in a payload; None if there is none."""
    try:
        message = decode(msgs.Probe, payload)
    except DecodeError:
        return None
    return Probe(message.target, message.nonce)


def encode_shutdown(request: Shutdown) -> bytes:
    """Return the payload of a request to end."""
    message = msgs.Shutdown()
    message.target, message.nonce = request.target, request.nonce
    message.requester = _sendable(request.requester)
    return encode(message)


def decode_shutdown(payload: bytes) -> Shutdown | None:
    """Return the request to end in a payload; None if there is none."""
    try:
        message = decode(msgs.Shutdown, payload)
    except DecodeError:
        return None
    return Shutdown(message.target, message.nonce, message.requester)


def encode_announcement(announcement: Announcement) -> bytes:
    """Return the payload of an announcement."""
    node = announcement.node
    message = msgs.Announcement()
    message.name, message.id, message.host = node.name, node.id, node.host
    message.pid, message.start_time = node.pid, node.start_time
    message.command, message.tool = _sendable(node.command), node.tool
    message.state = msgs.Announcement.LEAVING if announcement.leaving else msgs.Announcement.ALIVE
    message.revision = _revision(node)
    message.answers = announcement.answers
    message.ports = list(node.ports)
    message.endpoints = [_endpoint_message(endpoint) for endpoint in node.endpoints]
    message.sent, message.busy = node.sent, node.busy
    return encode(message)


def decode_announcement(payload: bytes) -> Announcement | None:
    """Return the announcement in a payload; None if it is of another version or type."""
    try:
        message = decode(msgs.Announcement, payload)
        endpoints = tuple(_endpoint(part) for part in message.endpoints)
        check_node(check_length(message.name))
    except (DecodeError, InvalidName, ValueError):
        return None
    node = Node(
        name=message.name,
        id=message.id,
        host=message.host,
        pid=message.pid,
        start_time=message.start_time,
        command=message.command,
        tool=bool(message.tool),
        ports=tuple(message.ports),
        endpoints=endpoints,
        busy=message.busy,
        sent=message.sent,
    )
    return Announcement(node, message.state == msgs.Announcement.LEAVING, message.answers)


def head_of(payload: bytes) -> Head:
    """Return the head of an announcement, read without decoding it."""
    if not payload.startswith(_FINGERPRINT):
        return Head(b"", b"")
    end = _NAME_OFFSET
    for fixed_bytes in (0, _BEFORE_ID_BYTES, _STATE_BYTES):  # after name, after host, after id
        end += 4 + int.from_bytes(payload[end : end + 4], "big") + fixed_bytes
    return Head(payload[_NAME_OFFSET:end], payload[end : end + _REVISION_BYTES])


def _revision(node: Node) -> int:
    """Return a number that changes with anything of a node but its endpoints' counters."""
    plain = [
        replace(one, messages=0, bytes=0, drops=0, last_time=0, calls=0, busy=0, longest=0)
        for one in node.endpoints
    ]
    structure = repr((node.command, node.tool, node.ports, plain)).encode("utf-8", "replace")
    digest = blake2b(structure, digest_size=_REVISION_BYTES).digest()
    return int.from_bytes(digest, "big", signed=True)


def _endpoint_message(endpoint: Endpoint) -> msgs.Endpoint:
    message = msgs.Endpoint()
    message.topic, message.role, message.group = endpoint.topic, endpoint.role, endpoint.group
    message.types = list(endpoint.types)
    message.fingerprints = [_signed(value) for value in endpoint.fingerprints]
    message.depth, message.drops = endpoint.depth, endpoint.drops
    message.messages, message.bytes = endpoint.messages, endpoint.bytes
    message.last_time = endpoint.last_time
    message.calls, message.busy, message.longest = endpoint.calls, endpoint.busy, endpoint.longest
    return message


def _endpoint(message: msgs.Endpoint) -> Endpoint:
    return Endpoint(
        topic=check_length(message.topic),
        role=Role(message.role),
        types=tuple(message.types),
        fingerprints=tuple(value & 0xFFFFFFFFFFFFFFFF for value in message.fingerprints),
        group=message.group,
        depth=message.depth,
        messages=message.messages,
        bytes=message.bytes,
        drops=message.drops,
        last_time=message.last_time,
        calls=message.calls,
        busy=message.busy,
        longest=message.longest,
    )


def _sendable(command: str) -> str:
    """Return a command line that can be sent each second: names may be no UTF-8, or thousands."""
    return command[:MOST_OF_COMMAND].encode("utf-8", "replace").decode()


def _signed(fingerprint: int) -> int:
    return fingerprint - (1 << 64) if fingerprint >= 1 << 63 else fingerprint
