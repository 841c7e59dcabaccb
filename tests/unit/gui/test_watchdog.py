"""The process that stops robots in the server's place: what it is told, and what it publishes."""

import json
import os
import threading
from collections.abc import Iterator
from queue import SimpleQueue

import pytest

from lcmtools.gui.watchdog import keep_watch

_LONG = 20.0  # [s] for what comes


class Watch:
    """A watch on a pipe, and what it publishes."""

    def __init__(self) -> None:
        stream, self._pipe = os.pipe()
        self.sent: SimpleQueue[tuple[str, bytes]] = SimpleQueue()
        publish = lambda topic, payload: self.sent.put((topic, payload))  # noqa: E731
        self.thread = threading.Thread(target=keep_watch, args=(stream, publish))
        self.thread.start()

    def tell(self, topic: str, stop: bytes) -> None:
        """Tell it what the server does."""
        os.write(self._pipe, json.dumps({"topic": topic, "stop": stop.hex()}).encode() + b"\n")

    def next(self) -> tuple[str, bytes]:
        """Return what it publishes next."""
        return self.sent.get(timeout=_LONG)

    def end(self) -> None:
        """End as the server does."""
        os.close(self._pipe)
        self.thread.join(_LONG)


@pytest.fixture
def watch() -> Iterator[Watch]:
    made = Watch()
    yield made
    if made.thread.is_alive():
        made.end()


def test_a_topic_is_stopped_when_the_server_is_silent(watch: Watch) -> None:
    watch.tell("/a", b"stop")
    assert [watch.next() for _ in range(3)] == [("/a", b"stop")] * 3


def test_every_driven_topic_is_stopped_when_the_server_is_gone(watch: Watch) -> None:
    for topic in ("/a", "/b", "/a", "/c"):
        watch.tell(topic, topic.encode())
    watch.tell("/b", b"")
    watch.end()
    sent = [watch.next() for _ in range(6)]
    assert {*sent} == {("/a", b"/a"), ("/c", b"/c")}
    assert watch.sent.empty()


def test_nothing_is_published_for_what_the_server_has_stopped(watch: Watch) -> None:
    watch.tell("/a", b"stop")
    watch.tell("/a", b"")
    watch.end()
    assert watch.sent.empty()
