"""Reading a node's parameters within a few hundredths of a second, for completion."""

import contextlib
import uuid
from collections.abc import Sequence

from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.codec import decode, encode
from lcmtools.node.parameters import service_name
from lcmtools.node.service import reply_channel, request_channel
from lcmtools.types.lcmtools_msgs import Parameter, Parameters, ServiceReply, ServiceRequest
from lcmtools.wire.datagram import short_message

_ANSWER = 0.08  # [s] within which a node must answer


def parameters_of(node: str, url: BusUrl) -> Sequence[Parameter]:
    """Return the parameters of a node by its full name; none if it does not answer.

    Raises:
        BusError: The bus is not multicast, or cannot be reached.
    """
    service = service_name(node)
    request = ServiceRequest()  # an empty request, which changes no parameter
    request.client, request.sequence = uuid.uuid4().hex, 1
    request.payload = encode(Parameters.Request())
    datagram = short_message(0, request_channel(service), encode(request))
    with QuickProbe(url, datagram, reply_channel(service)) as probe:
        for payload in probe.replies(reply_channel(service), _ANSWER):
            with contextlib.suppress(LcmtoolsError):
                reply = decode(ServiceReply, payload)
                if reply.client == request.client and reply.status == ServiceReply.OK:
                    return decode(Parameters.Response, reply.payload).parameters
    return ()
