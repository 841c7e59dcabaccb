"""A dead man's switch: which page drives which topic, until when, and the stops that follow.

Pure: the time is an argument [s]. Must not know messages or pages, which are just numbers here.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

HOLD = 0.35  # [s] for which one command is valid; a page repeats it every 0.1 s
STOPS = 3  # of a topic, if datagrams may be lost
STOP_GAP = 0.01  # [s] between the stops of a topic


@dataclass(slots=True)
class _Hold:
    """A topic that is driven, or being stopped: then ``stops`` remain to be sent."""

    page: int
    until: float
    stops: int = 0


class DeadMansSwitch:
    """The topics that pages drive.

    Only one page at a time drives a topic. It is stopped when that page releases it, is gone or is
    silent for HOLD, and when any page stops it; then the page that drove must release it first. A
    stop is sent ``stops`` times, because each may be lost.
    """

    def __init__(self, stops: int = 1) -> None:
        self._stops = stops
        self._holds: dict[str, _Hold] = {}
        self._overruled: dict[tuple[int, str], float] = {}  # pages that are ignored, until when

    def drive(self, page: int, topic: str, now: float) -> str:
        """Accept a page's command; return the reason if it is ignored, else ""."""
        if self._overruled.get((page, topic), -math.inf) > now:
            self._overruled[page, topic] = now + HOLD
            return "it was stopped by another page: release the controls first"
        hold = self._holds.get(topic)
        if hold and not hold.stops and hold.page != page and hold.until > now:
            return "another page is driving"
        self._holds[topic] = _Hold(page, now + HOLD)
        return ""

    def release(self, page: int, topic: str, now: float) -> None:
        """Stop a topic that the page drives."""
        self._overruled.pop((page, topic), None)
        hold = self._holds.get(topic)
        if hold and hold.page == page and not hold.stops:
            self._stop(hold, now)

    def stop(self, page: int, topic: str, now: float) -> None:
        """Stop a topic, even if another page or program drives it."""
        hold = self._holds.setdefault(topic, _Hold(page, now))
        if hold.page != page:
            self._overruled[hold.page, topic] = now + HOLD
        self._stop(hold, now)

    def leave(self, page: int, now: float) -> None:
        """Stop everything that a page drives, because the page is gone."""
        for hold in self._holds.values():
            if hold.page == page and not hold.stops:
                self._stop(hold, now)
        self._overruled = {key: until for key, until in self._overruled.items() if key[0] != page}

    def end(self, now: float) -> None:
        """Stop everything."""
        for hold in self._holds.values():
            if not hold.stops:
                self._stop(hold, now)

    def stops_due(self, now: float) -> Iterator[str]:
        """Yield the topics on which a stop must be sent now."""
        for topic, hold in list(self._holds.items()):
            if hold.until > now:
                continue
            if not hold.stops:  # its page was silent for too long
                self._stop(hold, now)
            hold.stops -= 1
            hold.until = now + STOP_GAP
            if not hold.stops:
                del self._holds[topic]
            yield topic

    @property
    def next_time(self) -> float:
        """The time of the next stop unless commands come; infinite if there is none."""
        return min((hold.until for hold in self._holds.values()), default=math.inf)

    def _stop(self, hold: _Hold, now: float) -> None:
        hold.stops, hold.until = self._stops, now
