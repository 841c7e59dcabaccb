"""Losses of nodes while they receive: said once, for this computer and for others."""

from dataclasses import replace

import pytest
from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence, Listener, SenderFacts
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness
from lcmtools.wire.packet import Sender

EAR = Node("/ear", "e", "h", 8, endpoints=(Endpoint("/map", Role.SUBSCRIBER, incomplete=3),))
LOST = EAR._replace(endpoints=(EAR.endpoints[0]._replace(incomplete=5),))
FULL = EAR._replace(overflows=7)
DROPPED = Listener("/ear", 8, 0, drops=40)


def look(now, **values):
    return replace(
        Evidence("udpm://x", before=Graph((EAR,)), graph=Graph((now,)), listened=1.0),
        **values,
    )


def said(evidence):
    found = judge(evidence)
    return [
        item.lstrip(" *")
        for one in found
        if one.rule == "incomplete-messages"
        for item in one.items
    ]


@pytest.mark.parametrize(
    ("evidence", "items"),
    [
        (look(EAR), []),
        (look(LOST), ["/ear lost 2 large messages of /map: parts of them did not arrive"]),
        (look(LOST._replace(stale=Staleness.HANGS)), []),
        (look(LOST._replace(tool=True)), []),
        (look(LOST, before=Graph()), []),
        (look(LOST, listeners=(DROPPED,)), []),  # its socket tells it
        (look(LOST, listeners=(DROPPED,), remote=frozenset("e")), ["/ear lost 2 large messages"]),
        (look(LOST, senders=(SenderFacts(Sender("a", 1), "a", messages=9, lost=5),)), []),
        (look(FULL), []),
        (look(FULL, remote=frozenset("e")), ["/ear: its full receive buffers dropped up to 7 dat"]),
    ],
)
def test_a_node_that_loses_messages_while_it_receives_is_named(evidence, items):
    found = said(evidence)
    assert len(found) == len(items)
    assert [text[: len(start)] for text, start in zip(found, items, strict=True)] == items
