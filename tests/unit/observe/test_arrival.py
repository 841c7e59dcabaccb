"""The clock that hz, bw and delay go by."""

from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness, Traffic
from lcmtools.messages.codec import encode
from lcmtools.observe.arrivals import CLOCK, ArrivalClock, is_simulated
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.wire.packet import Packet


def _tick(seconds: int) -> Packet:
    message = Clock()
    message.clock.sec = seconds
    return Packet(CLOCK, encode(message), 99)


def test_real_time_is_a_packets_own() -> None:
    clock = ArrivalClock(is_simulated=False)
    assert not clock.learn(_tick(5))
    assert clock.time(Packet("/a", b"", 7)) == 7


def test_simulated_time_is_what_the_clock_last_said() -> None:
    clock = ArrivalClock(is_simulated=True)
    assert clock.time(Packet("/a", b"", 7)) is None
    clock.learn(_tick(5))
    clock.learn(Packet(CLOCK, b"noise", 8))
    assert clock.time(Packet("/a", b"", 9)) == 5_000_000_000


def test_simulated_time_that_goes_back_is_noticed() -> None:
    clock = ArrivalClock(is_simulated=True)
    assert [clock.learn(_tick(seconds)) for seconds in (5, 6, 6, 1, 2)] == [
        False,
        False,
        False,
        True,
        False,
    ]


def test_time_is_simulated_where_a_living_node_or_a_program_publishes_the_clock() -> None:
    endpoint = Endpoint(CLOCK, Role.PUBLISHER)
    sim = Node("/sim", "id", "host", 1, endpoints=(endpoint,))
    dead = Node("/sim", "id", "host", 1, endpoints=(endpoint,), stale=Staleness.ENDED)
    assert is_simulated(Graph((sim,)))
    assert is_simulated(Graph((), (Traffic(CLOCK, None, (), 1, 8, 0, 0),)))
    assert not is_simulated(Graph((dead,)))
    assert not is_simulated(Graph())
