"""A process's context on a bus within the process: nodes without a network."""

from collections.abc import Callable, Iterator, Mapping

import pytest

import lcmtools.node.context
from lcmtools.arguments import split_arguments
from lcmtools.bus.base import FakeBus
from lcmtools.bus.records import NodeRecords
from lcmtools.node.context import Context


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
        monkeypatch.setattr(lcmtools.node.context._process, "context", context)
        return context

    yield open_context
    for context in opened:
        context.close()
