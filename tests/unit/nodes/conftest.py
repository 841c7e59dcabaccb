"""A bus within the process, on which a test starts nodes and speaks to them."""

from typing import TypeVar

import pytest
from fixtures.fake_bus import FakeBus

import lcmtools
import lcmtools.node.process
from lcmtools.arguments import split_arguments
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Message
from lcmtools.node.context import Context
from lcmtools.types.rosgraph_msgs import Clock

NodeT = TypeVar("NodeT", bound=lcmtools.Node)
MessageT = TypeVar("MessageT", bound=Message)


class NodeBench:
    """One node on a bus, driven step by step."""

    def __init__(self, set_context):
        self.bus = FakeBus()
        self._set_context = set_context
        self._context = None
        self._node = None

    def start(self, node_class, *words):
        """Make the node, with a command line."""
        arguments, _ = split_arguments(words)
        self._context = Context(self.bus, arguments, {})
        self._set_context(self._context)
        node = node_class()
        self._node = node
        return node

    def publish(self, topic, *messages):
        """Publish messages, and let the node deal with each."""
        assert self._node is not None
        for message in messages:
            self.bus.publish(topic, encode(message))
            lcmtools.spin_once(self._node)

    def advance_time(self, *seconds):
        """Let simulated time pass; the node was started with _use_sim_time:=true."""
        for time in seconds:
            clock = Clock()
            clock.clock.sec, clock.clock.nsec = divmod(round(time * 1e9), 10**9)
            self.publish("/clock", clock)

    def published(self, topic, message_type):
        """Return the messages of a topic that have been published."""
        published = tuple(self.bus.published)
        return [decode(message_type, payload) for channel, payload in published if channel == topic]

    def close(self):
        """End the node."""
        if self._context:
            self._context.close()


@pytest.fixture
def bench(monkeypatch):
    def set_context(context):
        monkeypatch.setattr(lcmtools.node.process._process, "context", context)

    bench = NodeBench(set_context)
    yield bench
    bench.close()
