"""One page: its open streams, its requests, and the frames sent to it.

A page is sent updates only as fast as it accepts them. Meanwhile, each stream keeps the newest, so
that a slow page sees less, while neither the bus nor the memory suffers.

A request is a function and a line in ``ASKS`` or, if it needs the right to command, in ``ACTIONS``.
It runs on its own thread, so that it may block.
"""

import asyncio
import math
import time
from collections import defaultdict, deque
from collections.abc import Callable, Mapping
from contextlib import AbstractAsyncContextManager, nullcontext
from importlib import import_module
from typing import TypeAlias

from websockets.asyncio.server import ServerConnection

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.access import COMMAND, PLAY
from lcmtools.gui.dead_man import LATEST_ACTION, LATEST_DRIVE, TOO_LATE, Lateness
from lcmtools.gui.protocol import (
    Frame,
    Json,
    MalformedRequest,
    PageRequest,
    read_request,
    text_frame,
)
from lcmtools.gui.source import Source
from lcmtools.gui.streams import stream_class
from lcmtools.gui.streams.pool import OpenStream, StreamPool

Answer: TypeAlias = Callable[..., Json]
"""Returns the answer to a source and the request's values as keyword arguments.

An LcmtoolsError is shown to the user.
"""

ASKS = {
    "color maps": "streams.image:color_maps",
    "node-parameters": "node_parameters:read",
    "numbers": "choices:numbers",
    "timeline": "playback:timeline",
    "topics": "choices:topics",
    "type": "type_forms:describe",
    "types": "type_forms:names",
}
"""The module and the function of each question."""
ACTIONS = {
    "call": "service_calls:call",
    "play": "playback:play",
    "publish": "streams.message_form:publish",
    "record": "streams.recording:record",
    "send-pose": "simulators:send_pose",
    "set-parameter": "node_parameters:change",
    "simulate": "simulators:simulate",
    "stop-recording": "streams.recording:stop",
}
"""The same for each action, which only a page with the right to command may request."""


def answer(name: str, table: Mapping[str, str]) -> Answer:
    """Return the function of a request; MalformedRequest if there is none with this name."""
    if name not in table:
        raise MalformedRequest(f"there is no request '{name[:40]}'")
    module, attribute = table[name].split(":")
    found: Answer = getattr(import_module(f"lcmtools.gui.{module}"), attribute)
    return found


_MOST_STREAMS = 300  # a world panel has one for each topic of each robot
_MOST_REQUESTS = 8  # pending requests; with more, a page waits for the first answer
_ANSWERED = ("ask", "do", "open")  # operations that get one frame as an answer
_STATE_PERIOD = 0.25  # [s]
_MAY_NOT = "this page may only watch, not command"
_BURST = 0.09  # [s] for which what comes after a late command has waited with it


class BrowserPage:
    """One page, at the other end of a socket."""

    def __init__(
        self, socket: ServerConnection, source: Source, streams: StreamPool, rights: tuple[str, ...]
    ) -> None:
        self._socket, self._source, self._streams, self._rights = socket, source, streams, rights
        self._open: dict[int, _Subscription] = {}
        self._outbox: deque[Frame] = deque()
        self._tasks: set[asyncio.Task[None]] = set()
        # Actions of one kind are executed in the order in which the page sends them.
        self._turns: dict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        self._state: Mapping[str, Json] = {}
        self._next_state = 0.0
        self._wakes = asyncio.Event()
        self._has_gone = asyncio.Event()
        self._operations: dict[str, Callable[[PageRequest], None]] = {
            **dict.fromkeys(("ask", "do"), self._answer),
            "open": self._open_stream,
            "close": self._close_stream,
            "took": self._take,
            **dict.fromkeys(("drive", "release", "stop"), self._steer),
        }
        self._refusals: dict[int, str] = {}
        self._lateness, self._late = Lateness(), 0.0  # [s] of the request that is being executed
        self._obsolete_until = 0.0  # commands to drive are ignored

    async def serve(self, hello: Mapping[str, Json]) -> None:
        """Serve the page until it is gone; MalformedRequest if it sends what no page would."""
        self._outbox.append(text_frame({"hello": hello}))
        both = [asyncio.ensure_future(work) for work in (self._read(), self._write())]
        try:
            done, _ = await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in (*both, *self._tasks):
                task.cancel()
            await asyncio.gather(*both, return_exceptions=True)
            if self._source.steering:
                self._source.steering.leave(id(self))
            for one in self._open.values():
                self._streams.close(one.stream)

    async def _read(self) -> None:
        async for data in self._socket:
            request = read_request(data)
            self._late = 0.0
            if request.sent is not None:
                self._late = self._lateness.of(request.sent, time.monotonic())
            if request.op in _ANSWERED:
                await self._has_room()
            if request.op not in self._operations:
                raise MalformedRequest(f"there is no operation '{request.op[:40]}'")
            self._operations[request.op](request)

    async def _has_room(self) -> None:
        """Wait while the page has too many pending answers, or does not accept them."""
        while len(self._tasks) + len(self._outbox) > _MOST_REQUESTS:
            self._has_gone.clear()
            await self._has_gone.wait()

    def _end(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        self._has_gone.set()

    def _open_stream(self, request: PageRequest) -> None:
        number, name = request.id, request.stream
        if stream_class(name).commands and (refusal := self._refusal(COMMAND)):
            self._send({"id": number, "problem": refusal})
            return
        if number not in self._open and len(self._open) >= _MOST_STREAMS:
            problem = "too much is shown on this page; close or hide some of it"
            self._send({"id": number, "problem": problem})
            return
        try:
            opened = _Subscription(
                number, self._streams.open(name, request.values), is_paced=request.paced
            )
        except LcmtoolsError as error:  # for example a mistyped value
            self._close_stream(request)
            self._send({"id": number, "problem": str(error)})
            return
        before, self._open[number] = self._open.get(number), opened
        if before:
            self._streams.close(before.stream)
        self._wakes.set()

    def _close_stream(self, request: PageRequest) -> None:
        if one := self._open.pop(request.id, None):
            self._streams.close(one.stream)

    def _take(self, request: PageRequest) -> None:
        """Let the next update of a stream follow, because the page has taken the last one."""
        if one := self._open.get(request.id):
            one.go_on()
            self._wakes.set()

    def _steer(self, request: PageRequest) -> None:
        """Command a robot; if the command is ignored, tell its stream why."""
        steering, refusal, now = self._source.steering, _MAY_NOT, time.monotonic()
        if self._late > LATEST_DRIVE:
            self._obsolete_until = now + _BURST
        if steering and COMMAND in self._rights:
            is_obsolete = request.op == "drive" and now < self._obsolete_until
            refusal = TOO_LATE if is_obsolete else steering.execute(id(self), request, self._late)
        if refusal != self._refusals.get(request.id, ""):
            self._refusals[request.id] = refusal
            self._send({"id": request.id, "data": {"refused": refusal}})

    def _answer(self, request: PageRequest) -> None:
        number, name, is_action = request.id, request.what, request.op == "do"
        function = answer(name, ACTIONS if is_action else ASKS)
        needed = PLAY if self._source.kind == "log" else COMMAND
        if is_action and (refusal := self._refusal(needed)):
            self._send({"id": number, "error": {"what": refusal, "hint": ""}})
            return
        turn = self._turns[name] if is_action else nullcontext()

        def work() -> Json:
            return function(self._source, **request.arguments(function))

        task = asyncio.ensure_future(self._reply(number, work, turn))
        self._tasks.add(task)  # it raises nothing
        task.add_done_callback(self._end)

    def _refusal(self, right: str) -> str:
        """Return why the page's present request to command is ignored; "" if it is not."""
        if right not in self._rights:
            return _MAY_NOT
        return TOO_LATE if self._late > LATEST_ACTION else ""

    async def _reply(
        self, number: int, work: Callable[[], Json], turn: AbstractAsyncContextManager[None]
    ) -> None:
        try:
            async with turn:
                self._send({"id": number, "answer": await asyncio.to_thread(work)})
        except LcmtoolsError as error:
            self._send({"id": number, "error": {"what": error.what, "hint": error.hint}})
        except Exception as error:  # noqa: BLE001 - shown in the panel; the server goes on
            what = f"a fault of lcmtools ({type(error).__name__}: {error})"
            self._send({"id": number, "error": {"what": what, "hint": ""}})

    def _send(self, values: Mapping[str, Json]) -> None:
        self._outbox.append(text_frame(values))
        self._wakes.set()

    async def _write(self) -> None:
        while True:
            while frame := self._next_frame():
                await self._socket.send(frame)
                self._has_gone.set()
            due = min([self._next_state, *(one.next_time for one in self._open.values())])
            pause = max(0.001, due - time.monotonic())
            # not wait_for(), which before Python 3.12 may miss the cancellation of this task
            timer = asyncio.get_running_loop().call_later(pause, self._wakes.set)
            try:
                await self._wakes.wait()
            finally:
                timer.cancel()
            self._wakes.clear()

    def _next_frame(self) -> Frame | None:
        """Return the next frame that is due: answers first, then the stream that waited longest."""
        if self._outbox:
            return self._outbox.popleft()
        now = time.monotonic()
        if now >= self._next_state:
            self._next_state = now + _STATE_PERIOD
            before, self._state = self._state, self._source.state()
            if self._state != before:
                return text_frame({"state": self._state})
        for one in sorted(self._open.values(), key=lambda one: one.next_time):
            if one.next_time > now:
                break
            if frame := one.next_frame(now):
                return frame
        return None


class _Subscription:
    """A stream that a page has open, and which of its updates the page has been sent.

    If it is paced, each update waits until the page has taken the one before.
    """

    def __init__(self, number: int, stream: OpenStream, *, is_paced: bool = False) -> None:
        self.number, self.stream, self.is_paced = number, stream, is_paced
        self.next_time = self._due = 0.0
        self._seen = 0
        self._problem = ""

    def next_frame(self, now: float) -> Frame | None:
        """Return the next update for the page; None if there is none yet in this period."""
        self.stream.refresh()
        if self.stream.problem != self._problem:
            self._problem = self.stream.problem
            return text_frame({"id": self.number, "problem": self._problem})
        self.next_time = now + self.stream.stream.period
        if self.stream.version == self._seen or self.stream.latest is None:
            return None
        self._seen = self.stream.version
        if self.is_paced:
            self._due, self.next_time = self.next_time, math.inf
        return self.stream.latest.frame(self.number)

    def go_on(self) -> None:
        """Let the next update follow, after the stream's period."""
        if self.next_time == math.inf:
            self.next_time = self._due
