"""Parameters of a running node: as rosparam names them, ``/driver/gain``, or as ros2 does.

The node itself is asked, as ``lcmtools param get`` asks it.
"""

import contextlib
import time
from collections.abc import Iterator, Sequence

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.cli.completion.words.nodes import nodes
from lcmtools.errors import LcmtoolsError
from lcmtools.types.lcmtools_msgs import Parameter

_ANSWER = 0.08  # [s] that a node has


def parameters(situation: Situation) -> Iterator[Candidate]:
    """Nodes; behind one its parameters; behind one of these the value it has."""
    before = [word for key in ("words", "node", "name") for word in situation.given.get(key, ())]
    if not before:
        yield from _first(situation)
        return
    for one in _asked(situation, _full(before[0], situation)):
        if len(before) == 1:
            yield Candidate(one.name, f"{one.type}, {one.value}")
        elif one.name == before[1]:
            yield Candidate(one.value, one.type)


def _first(situation: Situation) -> Iterator[Candidate]:
    """Nodes, and the parameters of one that is written out with a slash behind it."""
    found = list(nodes(situation))
    yield from found
    name, slash, _ = situation.word.rpartition("/")
    if slash and name and not any(one.value.startswith(situation.word) for one in found):
        for one in _asked(situation, _full(name, situation)):
            yield Candidate(f"{name}/{one.name}", f"{one.type}, {one.value}")


def _full(name: str, situation: Situation) -> str:
    """A node's full name; where only its last part is written, the bus is asked."""
    if name.startswith("/"):
        return name
    return next((node.name for node in situation.graph.named(name)), f"/{name}")


def _asked(situation: Situation, node: str) -> Sequence[Parameter]:
    """The parameters of a node; none where it does not answer."""
    from lcmtools.bus.quick_probe import QuickProbe
    from lcmtools.messages.codec import decode
    from lcmtools.node.parameters import service_name
    from lcmtools.node.service import reply_channel, request_channel
    from lcmtools.types.lcmtools_msgs import Parameters, ServiceReply

    service = service_name(node)
    client, question = _question(request_channel(service))
    deadline = time.monotonic() + _ANSWER
    with (
        contextlib.suppress(LcmtoolsError, OSError),
        QuickProbe(situation.url, question, reply_channel(service)) as quick_probe,
    ):
        for payload in quick_probe.replies(reply_channel(service), deadline):
            with contextlib.suppress(LcmtoolsError):
                reply = decode(ServiceReply, payload)
                if reply.client == client and reply.status == ServiceReply.OK:
                    return decode(Parameters.Response, reply.payload).parameters
    return ()


def _question(channel: str) -> tuple[str, bytes]:
    """Who asks, and the datagram that asks for all parameters and changes none."""
    import uuid

    from lcmtools.messages.codec import encode
    from lcmtools.types.lcmtools_msgs import Parameters, ServiceRequest
    from lcmtools.wire.datagram import short_message

    request = ServiceRequest()
    request.client, request.sequence = uuid.uuid4().hex, 1
    request.payload = encode(Parameters.Request())
    return request.client, short_message(0, channel, encode(request))
