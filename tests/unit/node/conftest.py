"""A process's context on a bus within the process: nodes without a network."""

import threading
import time

import pytest
from fixtures.fake_bus import FakeBus

import lcmtools.node.process
from lcmtools import Node
from lcmtools.arguments import split_arguments
from lcmtools.node.context import Context
from lcmtools.types.std_srvs import SetBool


@pytest.fixture
def bus():
    """The bus that ``begin`` takes when it is given none."""
    return FakeBus()


@pytest.fixture
def begin(bus, monkeypatch):
    """``begin(*words, environment={}, bus=..., records=None)``: what lcmtools.init() does."""
    opened = []
    own_bus = bus

    def open_context(*words, environment=None, bus=None, records=None):
        said, _ = split_arguments(words)
        context = Context(bus or own_bus, said, environment or {}, records)
        opened.append(context)
        monkeypatch.setattr(lcmtools.node.process._process, "context", context)
        return context

    yield open_context
    for context in opened:
        context.close()


@pytest.fixture
def serve():
    """Spins a node on a thread of its own until the test ends."""
    stop = threading.Event()
    threads = []

    def spin(node):
        while not stop.is_set():
            node.callbacks.run_ready()
            time.sleep(0.001)

    def start(node):
        threads.append(threading.Thread(target=spin, args=[node]))
        threads[-1].start()

    yield start
    stop.set()
    for thread in threads:
        thread.join()


@pytest.fixture
def logged(capsys):
    """Return whether a text has been logged so far; a server logs after it has replied."""
    log = []

    def is_logged(text):
        log.append(capsys.readouterr().err)
        return text in "".join(log)

    return is_logged


class SwitchServer:
    """A node with the service /switch, which repeats what it is told.

    Attributes:
        node: The node, for ``serve`` to spin.
        calls: What the callback was told.
    """

    def __init__(self):
        self.node = Node("server")
        self.calls = []
        self.node.create_service(SetBool, "switch", self._answer)

    def _answer(self, request, response):
        self.calls.append(request.data)
        response.success, response.message = request.data, f"call {len(self.calls)}"
        return response


@pytest.fixture
def start_switch():
    """Makes a SwitchServer in the context that ``begin`` made."""
    return SwitchServer
