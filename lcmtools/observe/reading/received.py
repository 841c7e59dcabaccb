"""Decoded messages of topics, from a bus or a log, for Python programs."""

import os
import warnings
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from lcmtools.bounded import BoundedDict
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.errors import DecodeError, UsageError
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.messages.filter import Filter
from lcmtools.messages.registry import Message
from lcmtools.messages.supply import has_supply
from lcmtools.names import Resolver, resolve_namespace
from lcmtools.observe.reading.arrivals import ArrivalStream, SelectedPacket, taken
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.selection import select_topics
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.observe.reading.sources import LogObserver
from lcmtools.packages import provide_user_types
from lcmtools.settings import read_user_file, usual_namespace
from lcmtools.wire.packet import Packet


@dataclass(frozen=True, slots=True)
class Arrival:
    """A message that arrived.

    Attributes:
        topic: The topic's name on the bus.
        decoded: The message; or the error, if the payload is none of a known type.
        time: The time of arrival [ns since 1970]: from the kernel; simulated time if a simulator
            publishes ``/clock``; in a log, the time of recording.
        sender: The sender: a node's name, else a process, else an address; "unknown sender" if the
            bus does not name it (tcpq, memq, logs).
        packet: The message as it arrived, with its bytes and sequence number.
    """

    topic: str
    decoded: Message | DecodeError
    time: int
    sender: str
    packet: Packet

    @property
    def message(self) -> Message:
        """The message; raises DecodeError if the payload is none of a known type."""
        if isinstance(self.decoded, DecodeError):
            raise self.decoded
        return self.decoded

    @property
    def payload(self) -> bytes:
        """The message as it arrived."""
        return self.packet.payload


def messages(  # noqa: PLR0913 - each is a separate option
    *topics: str,
    url: str | None = None,
    log: str | Path | Sequence[str | Path] | None = None,
    where: str | None = None,
    timeout: float | None = None,
    wall_time: bool = False,
    on_error: Callable[[DecodeError], None] | None = None,
    undecoded: bool = False,
    between: tuple[int, int] | None = None,
) -> Generator[Arrival, None, None]:
    """Yield the messages of topics as they arrive on a bus, or all those in a log.

    The bus is opened at once, so that no message sent after the call is missed. It is left when the
    generator is closed: at the end of the log, by ``close()`` or by ``contextlib.closing``. No
    signal handler is set and nothing is printed.

    Args:
        *topics: Names or patterns (see ``lcmtools.names.Pattern``). A relative name is the plain
            LCM channel or the topic in the namespace LCMTOOLS_NAMESPACE, whichever exists.
        url: The bus; None for the one that the environment and the settings file select.
        log: A log file to read at once, instead of a bus, or several as one.
        where: Yield only messages for which this expression, as of ``echo --filter``, is true:
            ``"m.pose.pose.position.x > 1"``. Those that cannot be decoded are left out.
        timeout: The longest time without a message [s]; None for no limit.
        wall_time: Use the system clock even if a simulator publishes /clock.
        on_error: Called for each message that is left out because it cannot be decoded; None for
            a Python warning, once for each error.
        undecoded: Yield an arrival for such a message, too; its ``message`` raises the error.
        between: For a log, first and last time of recording of the messages [ns since 1970].

    Raises:
        UsageError: A topic, the URL or the expression is wrong.
        BusError: The bus cannot be reached, or the log cannot be read.
        NothingReceived: No message came for ``timeout`` seconds.
        ValueMismatch: The expression does not fit a message.
        LcmtoolsError: The log has no message on the topics.
    """
    if not has_supply():
        provide_user_types()
    if not topics:
        raise UsageError("no topic is named", 'for example messages("/chatter")')
    if url is not None and log is not None:
        raise UsageError("a log is read instead of a bus", "leave out url or log")
    condition = None if where is None else Filter(where)
    names = usual_names()
    selections = [select_topics(topic, names, with_path=False) for topic in topics]
    with ExitStack() as stack:
        monitor = stack.enter_context(_monitor(url, log, between))
        monitor.discover()
        stream = ArrivalStream(
            monitor, selections, names, wall_time=wall_time or not monitor.is_live, strict_time=True
        )
        leave_out = None if undecoded and not condition else on_error or _warner()
        arrivals = _decoded(monitor, stream, condition, leave_out)
        found = _left_in_the_end(stack.pop_all(), taken(stream, arrivals, timeout))
    next(found)  # runs to its first yield: from now on, closing it leaves the bus
    return cast("Generator[Arrival, None, None]", found)


def usual_names() -> Resolver:
    """Return a resolver that puts relative names into the namespace LCMTOOLS_NAMESPACE."""
    return Resolver(resolve_namespace(usual_namespace(os.environ)))


def _monitor(
    url: str | None,
    log: str | Path | Sequence[str | Path] | None,
    between: tuple[int, int] | None,
) -> BusMonitor:
    if log is not None:
        paths = [log] if isinstance(log, (str, Path)) else log
        url_of_logs = BusUrl("file", ",".join(map(str, paths)))
        observer = LogObserver(*paths, between=between)
        return BusMonitor(url_of_logs, "messages", os.environ, observer)
    chosen, _ = choose_url(url, None, os.environ, read_user_file(os.environ))
    return BusMonitor(chosen, "messages", os.environ, whole=True, plays=False)


def _decoded(
    monitor: BusMonitor,
    stream: ArrivalStream,
    condition: Filter | None,
    leave_out: Callable[[DecodeError], None] | None,
) -> Callable[[SelectedPacket], Arrival | None]:
    decoder, senders = Decoder(monitor.types_of), SenderNames()

    def to_arrival(found: SelectedPacket) -> Arrival | None:
        packet = found.packet
        decoded: Message | DecodeError
        try:
            decoded = decoder.decode(packet)
        except DecodeError as error:
            if leave_out is not None:
                leave_out(DecodeError(f"{packet.channel}: {error}"))
                return None
            decoded = error
        else:
            if condition and not condition.matches(decoded):
                return None
        if packet.sender is not None:
            senders.update([packet.sender], stream.graph.nodes)
        return Arrival(packet.channel, decoded, found.time, senders.name(packet.sender), packet)

    return to_arrival


def _warner() -> Callable[[DecodeError], None]:
    """Return a function that warns of each error once."""
    told = BoundedDict[str, bool](MOST_FLOWS)

    def warn(error: DecodeError) -> None:
        if not told.use(error.what):
            told[error.what] = True
            warnings.warn(f"a message is left out: {error}", stacklevel=7)  # of the loop

    return warn


def _left_in_the_end(
    stack: ExitStack, arrivals: Iterator[Arrival]
) -> Generator[Arrival | None, None, None]:
    """Yield None, then the arrivals; close the stack with the generator."""
    with stack:
        yield None
        yield from arrivals
