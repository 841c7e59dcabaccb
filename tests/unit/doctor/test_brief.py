"""A brief look is enough among nodes that were heard; everything else takes a whole second."""

from dataclasses import replace

import pytest
from fixtures.judging import HEALTHY, NOW, SECOND, SOMEBODY, pub, stream, sub

from lcmtools.doctor.brief import BRIEF, is_enough, needed_duration
from lcmtools.doctor.evidence import (
    Evidence,
    Host,
    LcmProcess,
    Listener,
    SimulatedClock,
    Stream,
)
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness
from lcmtools.wire.packet import Sender

_TALKER = Sender("127.0.0.1", 4000)
_STEP = SECOND // 10


def _node(name: str, pid: int, end: Endpoint, **values: object) -> Node:
    known = {"start_time": NOW - 100 * SECOND, "sent": NOW, "last_announced": NOW, **values}
    return Node(name, name, "husky", pid, endpoints=(end,), **known)  # type: ignore[arg-type]


def _brief(
    *,
    messages: int = 7,
    last: int = NOW,
    period: int = _STEP,
    busy: int = 0,
    times: tuple[int, ...] = (),
    nodes: tuple[Node, ...] = (),
    **values: object,
) -> Evidence:
    """A look at a talker and an ear; the talker sent so many messages meanwhile."""
    sent = (NOW - 100 * SECOND, NOW - round(BRIEF * SECOND))
    usual = (sent[1] - sent[0]) // period
    said = pub("/a", "std_msgs/String")._replace(messages=usual, last_time=sent[1])
    heard = sub("/a", "std_msgs/String")._replace(messages=usual, last_time=sent[1], calls=usual)
    talker = _node("/talker", 7, said, sender=_TALKER)
    ear = _node("/ear", 8, heard, sender=Sender("127.0.0.1", 5000))
    later = said._replace(messages=usual + messages, last_time=last)
    after = (talker._replace(endpoints=(later,)), ear._replace(busy=busy), *nodes)
    before = tuple(one._replace(sent=sent[1]) for one in (talker, ear))
    times = times or tuple(range(NOW - 6 * _STEP, NOW + 1, _STEP))
    known = {
        "graph": Graph(after, (), NOW),
        "before": Graph(before, (), sent[1]),
        "listened": BRIEF,
        "streams": (Stream("/a", _TALKER, "/talker", times, pid=7),),
        "processes": (LcmProcess(7, "talker"), LcmProcess(8, "ear")),
        "listeners": (Listener("/ear", 8, 1000, is_node=True),),
        **values,
    }
    return replace(HEALTHY, **known)  # type: ignore[arg-type]


def test_among_nodes_that_were_heard_a_brief_look_is_enough() -> None:
    assert is_enough(_brief())
    assert is_enough(_brief(processes=(LcmProcess(9, "other", bus="udpm://239.1.1.1:1"),)))
    assert is_enough(_brief(messages=0, last=NOW - 5 * SECOND, period=6 * SECOND))


@pytest.mark.parametrize(
    "evidence",
    [
        pytest.param(_brief(ttl=1), id="other computers may send"),
        pytest.param(_brief(url="tcpq://127.0.0.1:7700"), id="no multicast"),
        pytest.param(_brief(host=Host(has_sockets=False)), id="programs cannot be seen"),
        pytest.param(_brief(remote=frozenset({"/talker"})), id="a node elsewhere"),
        pytest.param(_brief(processes=(LcmProcess(9, "plain"),)), id="a program that is no node"),
        pytest.param(_brief(listeners=(Listener("l", None, 0),)), id="an unknown listener"),
        pytest.param(_brief(graph=Graph((), SOMEBODY, NOW)), id="an unknown sender"),
        pytest.param(_brief(own_drops=1), id="missed datagrams"),
        pytest.param(_brief(messages=0, last=NOW - SECOND, period=SECOND), id="a topic at 1 Hz"),
        pytest.param(_brief(messages=1, last=NOW, period=SECOND // 3), id="2 of 3 Hz missing"),
        pytest.param(_brief(busy=SECOND // 2), id="a busy node"),
        pytest.param(
            _brief(times=(*range(NOW - 70 * 10**7, NOW - 20 * 10**7, 10**7), NOW)), id="a gap"
        ),
        pytest.param(
            _brief(nodes=(_node("/dead", 9, sub("/a"), stale=Staleness.ENDED),)), id="a fault"
        ),
    ],
)
def test_what_only_listening_shows_takes_a_whole_look(evidence: Evidence) -> None:
    assert not is_enough(evidence)


def test_an_even_stream_of_a_node_is_no_gap() -> None:
    even = replace(stream("/a", 100.0, count=70), sender=_TALKER, name="/talker", pid=7)
    assert is_enough(_brief(streams=(even,)))


@pytest.mark.parametrize("is_back", [True, False])
def test_a_node_that_has_left_may_be_starting_again(is_back: bool) -> None:  # noqa: FBT001
    node = Node("/talker", "1", "here", 7, sent=1)
    after = (node._replace(id="2"),) if is_back else ()
    evidence = Evidence("udpm://", before=Graph((node,)), graph=Graph(after), listened=0.7)
    assert needed_duration(evidence) == (0.0 if is_back else 3.0)


def test_of_publishers_of_one_topic_all_should_be_seen() -> None:
    end = Endpoint("/cmd", Role.PUBLISHER, messages=5, last_time=SECOND)
    nodes = tuple(Node(f"/{n}", n, "here", 7, endpoints=(end,), sent=2 * SECOND) for n in "ab")
    streams = tuple(Stream("/cmd", None, node.name, (1, 2)) for node in nodes)
    seen = Evidence("udpm://", graph=Graph(nodes), streams=streams, listened=0.7)
    assert needed_duration(seen) == 0.0
    assert needed_duration(replace(seen, streams=streams[:1])) == 3.0


def test_of_a_clock_that_seldom_ticks_more_should_be_seen() -> None:
    streams = (Stream("/clock", None, "sim", (1,)),)
    seen = Evidence("udpm://", streams=streams, listened=0.7)
    assert needed_duration(seen) == 3.0
    assert needed_duration(replace(seen, clock=SimulatedClock("sim", 1.0))) == 0.0
