"""The topics that are offered to Foxglove, without a server."""

from types import SimpleNamespace

from lcmtools.bag.choice import RecordedTopics
from lcmtools.bus.url import parse_url
from lcmtools.foxglove.bridge import Bridge
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.observe.reading.find import GLOBAL


class Server:
    """Notes what is offered, and what is taken back."""

    def __init__(self):
        self.offered = []

    def offer(self, topic, *_):
        """Take note of a topic."""
        self.offered.append(topic)
        return SimpleNamespace(close=lambda: self.offered.remove(topic))

    def draw(self, _):
        """Draw nothing."""


def test_many_new_topics_are_offered_a_few_at_a_time():
    """A client for whom too many of them wait is disconnected by the package."""
    server = Server()
    monitor = SimpleNamespace(types_of=lambda _: (), url=parse_url("memq://"), listen_to=print)
    ends = [Endpoint(f"/t{number}", Role.PUBLISHER, ("std_msgs/String",)) for number in range(70)]
    graph = Graph((NodeInfo("/n", "/n", "h", 7, endpoints=tuple(ends)),))
    bridge = Bridge(monitor, RecordedTopics((), GLOBAL), print)
    counts = []
    has_more = True
    while has_more:
        has_more = bridge.update_offers(graph, server)
        counts.append(len(server.offered))
    assert counts == [32, 64, 70]
    assert not bridge.update_offers(Graph(), server)
    assert server.offered == []


def test_names_that_are_not_for_clients_are_left_out():
    server = Server()
    monitor = SimpleNamespace(types_of=lambda _: (), url=parse_url("memq://"), listen_to=print)
    names = ("/a", "b\udcff", "\x1b[2J")
    ends = [Endpoint(name, Role.PUBLISHER, ("std_msgs/String",)) for name in names]
    bridge = Bridge(monitor, RecordedTopics((), GLOBAL), print)
    graph = Graph((NodeInfo("/n", "/n", "h", 7, endpoints=tuple(ends)),))
    bridge.update_offers(graph, server)
    assert server.offered == ["/a"]
