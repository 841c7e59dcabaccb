"""A process's context on a bus within the process: nodes without a network."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping

import pytest
from fixtures.fake_bus import FakeBus

import lcmtools.node.process
from lcmtools import Node
from lcmtools.arguments import split_arguments
from lcmtools.bus.records import NodeRecords
from lcmtools.node.context import Context
from lcmtools.types.std_srvs import SetBool


@pytest.fixture
def bus() -> FakeBus:
    """The bus that ``begin`` takes when it is given none."""
    return FakeBus()


@pytest.fixture
def begin(bus: FakeBus, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Context]]:
    """``begin(*words, environment={}, bus=..., records=None)``: what lcmtools.init() does."""
    opened: list[Context] = []
    own_bus = bus

    def open_context(
        *words: str,
        environment: Mapping[str, str] | None = None,
        bus: FakeBus | None = None,
        records: NodeRecords | None = None,
    ) -> Context:
        said, _ = split_arguments(words)
        context = Context(bus or own_bus, said, environment or {}, records)
        opened.append(context)
        monkeypatch.setattr(lcmtools.node.process._process, "context", context)
        return context

    yield open_context
    for context in opened:
        context.close()


@pytest.fixture
def serve() -> Iterator[Callable[[Node], None]]:
    """Spins a node on a thread of its own until the test ends."""
    stop = threading.Event()
    threads: list[threading.Thread] = []

    def spin(node: Node) -> None:
        while not stop.is_set():
            node.callbacks.run_ready()
            time.sleep(0.001)

    def start(node: Node) -> None:
        threads.append(threading.Thread(target=spin, args=[node]))
        threads[-1].start()

    yield start
    stop.set()
    for thread in threads:
        thread.join()


@pytest.fixture
def logged(capsys: pytest.CaptureFixture[str]) -> Callable[[str], bool]:
    """Return whether a text has been logged so far; a server logs after it has replied."""
    log: list[str] = []

    def is_logged(text: str) -> bool:
        log.append(capsys.readouterr().err)
        return text in "".join(log)

    return is_logged


class SwitchServer:
    """A node with the service /switch, which repeats what it is told.

    Attributes:
        node: The node, for ``serve`` to spin.
        calls: What the callback was told.
    """

    def __init__(self) -> None:
        self.node = Node("server")
        self.calls: list[bool] = []
        self.node.create_service(SetBool, "switch", self._answer)

    def _answer(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self.calls.append(request.data)
        response.success, response.message = request.data, f"call {len(self.calls)}"
        return response


@pytest.fixture
def start_switch() -> type[SwitchServer]:
    """Makes a SwitchServer in the context that ``begin`` made."""
    return SwitchServer
