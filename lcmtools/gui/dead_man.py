"""A dead man's switch: which page drives which topic, until when, and the stops that follow.

Commands that waited on their way, for a suspended server or in a broken network, come too late to
count: the clocks of page and server differ by an unknown constant, and the least difference seen so
far counts as no delay. Pure: the time is an argument [s]. Must not know messages or pages, which
are just bytes and numbers here.
"""

import json
import math
from collections.abc import Iterator
from typing import NamedTuple

HOLD = 0.35  # [s] for which one command is valid; a page repeats it every 0.1 s
STOPS = 3  # of a topic, if datagrams may be lost
STOP_GAP = 0.01  # [s] between the stops of a topic
TOO_LATE = "it came too late from the page: nothing was sent"


class Command(NamedTuple):
    """A page's "drive", "release" or "stop" of a topic; the release of "" is that of all topics."""

    op: str
    page: int
    topic: str = ""
    kind: tuple[str, int] = ("", 0)  # the type's name and fingerprint
    payload: bytes = b""  # that drives
    stop: bytes = b""  # that stops the same
    until: float = 0.0  # when it is no longer valid [s], by the clock that all processes share

    def line(self) -> bytes:
        """Return it as a line of JSON, of any length."""
        payloads = self.payload.hex(), self.stop.hex()
        return json.dumps([*self[:4], *payloads, self.until]).encode() + b"\n"

    @classmethod
    def of(cls, line: bytes) -> "Command":
        """Return the command in a line."""
        op, page, topic, (name, number), payload, stop, until = json.loads(line)
        payloads = bytes.fromhex(payload), bytes.fromhex(stop)
        return cls(op, page, topic, (name, number), *payloads, until)

    def releases(self, page: int, topic: str) -> bool:
        """Return whether it ends what a page does to a topic."""
        return self.op != "drive" and self.page == page and self.topic in ("", topic)


class _Hold(NamedTuple):
    """A topic that is driven, or being stopped if stops have been sent; the next one is ``due``."""

    command: Command
    due: float
    sent: int = 0


class DeadMansSwitch:
    """The topics that pages drive.

    Only one page at a time drives a topic. It is stopped when that page releases it, is gone or is
    silent until its command is no longer valid, and when any page stops it; then the page that
    drove must release it first. A stop has the type that the topic was driven by, and is sent
    ``stops`` times, because each may be lost.
    """

    def __init__(self, stops: int = 1) -> None:
        self._stops = stops
        self._holds: dict[tuple[str, tuple[str, int]], _Hold] = {}  # by topic and type
        self._overruled: dict[tuple[int, str], float] = {}  # pages that are ignored, until when

    def take(self, command: Command, now: float) -> str:
        """Execute a command; return the reason if it is ignored, else ""."""
        key = command.topic, command.kind
        if command.op == "drive":
            if not (refusal := self._refusal(command, now)):
                self._holds[key] = _Hold(command, command.until)
            return refusal
        self._overruled = {k: at for k, at in self._overruled.items() if not command.releases(*k)}
        self._end(command, now)
        if command.op == "stop":  # also where no page drives
            self._holds[key] = _Hold(command, now)
        return ""

    def end(self, now: float) -> None:
        """Stop everything."""
        for page in {hold.command.page for hold in self._holds.values()}:
            self._end(Command("release", page), now)

    def stops_due(self, now: float) -> Iterator[Command]:
        """Yield the commands whose stop must be sent now."""
        for key, (command, due, sent) in list(self._holds.items()):
            if due > now:
                continue
            self._holds[key] = _Hold(command, now + STOP_GAP, sent + 1)
            if sent + 1 == self._stops:
                del self._holds[key]
            yield command

    @property
    def next_time(self) -> float:
        """The time of the next stop unless commands come; infinite if there is none."""
        return min((hold.due for hold in self._holds.values()), default=math.inf)

    def _refusal(self, command: Command, now: float) -> str:
        page, topic = command.page, command.topic
        if self._overruled.get((page, topic), -math.inf) > now:
            self._overruled[page, topic] = now + HOLD
            return "it was stopped by another page: release the controls first"
        if command.until <= now:
            return TOO_LATE
        for other, due, sent in self._holds.values():
            if other.topic == topic and other.page != page and due > now and not sent:
                return "another page is driving"
        return ""

    def _end(self, command: Command, now: float) -> None:
        """Let the commands that another one stops or releases be stopped now."""
        for key, (driving, _, sent) in self._holds.items():
            is_stopped = command.op == "stop" and driving.topic == command.topic
            if sent or not (is_stopped or command.releases(driving.page, driving.topic)):
                continue
            self._holds[key] = _Hold(driving, now)
            if driving.page != command.page:
                self._overruled[driving.page, driving.topic] = now + HOLD


LATEST_DRIVE = HOLD  # [s] after which a command to drive is obsolete
LATEST_ACTION = 2.0  # [s] the same for a click
_DRIFT = 1e-4  # between two clocks, as a fraction
_LONGEST_GAP = 0.2  # [s] that counts between two requests: what has waited comes all at once
_ENOUGH = 3.0  # [s] of lateness at a steady rate after which a clock was set, or stood still


class Lateness:
    """The lateness of one page's requests."""

    def __init__(self) -> None:
        self._least: float | None = None
        self._sent = self._came = self._late_time = 0.0

    def of(self, sent: float, now: float) -> float:
        """Return how late a request is that comes now [s]."""
        difference = now - sent
        if self._least is None:
            self._least, self._sent, self._came = difference, sent, now
        self._least += max(0.0, sent - self._sent) * _DRIFT
        late = difference - self._least
        is_late = late > LATEST_DRIVE
        gap = min(now - self._came, _LONGEST_GAP)
        self._late_time = self._late_time + gap if is_late else 0.0
        self._sent, self._came = sent, now
        if late < 0 or self._late_time > _ENOUGH:
            self._least, late = difference, 0.0
        return late
