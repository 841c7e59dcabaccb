"""Sources of packets: a bus, or a log, which is read at once by its own times.

Belongs here: the choice of the observer for a URL. Nothing above needs to know it.
"""

from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

_BATCH = 100  # messages of a log are read at a time, so that reading can be stopped


class Observer(Protocol):
    """A source that sees all messages: the tap, a subscription to everything, or a log."""

    is_live: bool  # messages come in real time; else a log is read at once, by its own times

    @property
    def is_awaiting(self) -> bool:
        """True while answers to a probe may still come, if the bus can tell."""

    @property
    def has_strangers(self) -> bool:
        """True if the bus knows of programs that do not answer probes, and may publish."""

    @property
    def numbered(self) -> Mapping[Sender, Sequence]:
        """The sequences of those senders whose sequence numbers show losses."""

    @property
    def is_log(self) -> bool:
        """True for a log, even a played one: no node answers or subscribes."""

    @property
    def port(self) -> int:
        """The UDP port that ``send`` sends from; 0 if there is none."""

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first.

        Raises:
            EOFError: The source is a log, and it has ended.
        """

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message; does nothing on a log."""

    def close(self) -> None:
        """Leave the bus."""


class LogObserver:
    """The messages of log files, as fast as they can be read, with the times of recording.

    ``between`` is the first and last time of the messages that count [ns since 1970], ``last`` the
    number of the last ones of each channel that count; None for all.
    """

    port = 0
    is_live, is_log, is_awaiting, has_strangers = False, True, False, False
    numbered: Mapping[Sender, Sequence] = MappingProxyType({})

    def __init__(
        self,
        *paths: str | Path,
        between: tuple[int, int] | None = None,
        last: int | None = None,
    ) -> None:
        from lcmtools.observe.reading.logs import Logs

        self.logs: Logs = Logs(paths)  # whose indexes may know nodes, types and losses
        self.logs.between, self._last = between, last
        self._packets: Iterator[Packet] | None = None

    def rewind(self) -> None:
        """Begin again with the first message."""
        self._packets = None

    def receive(self, timeout: float) -> list[Packet]:  # noqa: ARG002 - a log never waits
        """Return the next messages; raises BusError if the file cannot be read."""
        if self._packets is None:
            logs, last = self.logs, self._last
            self._packets = logs.packets() if last is None else logs.last(last)
        packets = list(islice(self._packets, _BATCH))
        if not packets:
            raise EOFError
        return packets

    def send(self, channel: str, payload: bytes) -> None:
        """Do nothing: a log has no subscriber."""

    def close(self) -> None:
        """Close the file."""
        self._packets = iter(())
        self.logs.close()


def open_observer(
    url: BusUrl,
    *,
    whole: bool = False,
    plays: bool = True,
    on_outage: Callable[[str, str], None] = lambda _text, _trouble: None,
) -> Observer:
    """Return the best observer of a bus or a log; see ``BusMonitor``.

    ``on_outage`` is called when the connection is lost or restored, with a sentence and the current
    problem, "" for none.
    """
    if url.is_multicast:
        return Tap(url, whole=whole)
    if url.provider == "file" and not plays:
        from lcmtools.bus.preflight import check_bus

        check_bus(url)
        return LogObserver(url.network)
    if url.provider == "zenoh":
        from lcmtools.bus.zenoh.observer import ZenohObserver

        return ZenohObserver(url, on_outage)
    from lcmtools.bus.lcm_observer import LcmObserver

    return LcmObserver(url, on_outage)
