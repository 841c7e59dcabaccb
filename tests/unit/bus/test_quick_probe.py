"""The datagram of a quick probe."""

import pytest

from lcmtools.bus.quick_probe import PROBE, QuickProbe
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError
from lcmtools.graph.protocol import PROBE_CHANNEL, Probe, encode_probe
from lcmtools.wire.datagram import short_message


def test_the_question_is_the_probe_of_the_protocol():
    assert short_message(0, PROBE_CHANNEL, encode_probe(Probe())) == PROBE


def test_only_a_multicast_bus_can_be_probed():
    with pytest.raises(BusError, match="multicast"):
        QuickProbe(parse_url("tcpq://127.0.0.1:7700"))
