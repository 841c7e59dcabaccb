"""Pulling the messages of some topics and saying when to report: what hz, bw and delay share."""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from lcmtools.cli.find import ask_nodes, known_spelling, near_topic
from lcmtools.cli.options import duration, topic_spellings
from lcmtools.cli.output import talk
from lcmtools.errors import NothingReceived
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    from lcmtools.bus.watch import Watch

_REPORT_PERIOD = 1.0  # [s]
_PATIENCE = 2.0  # [s] without a message before the person is told what is on the bus

timeout_option = click.option(
    "--timeout", type=duration, help="Give up (exit code 4) when none comes so long."
)


@dataclass(frozen=True, slots=True)
class Turn:
    """What came in a moment.

    Attributes:
        arrivals: Messages, each with the topic as it was typed.
        is_due: It is time to report.
    """

    arrivals: tuple[tuple[str, Packet], ...] = ()
    is_due: bool = False


@contextmanager
def reported_when_interrupted(report: Callable[[], None]) -> Iterator[None]:
    """Report once more when Ctrl-C ends what is within, so that a short measurement shows too."""
    try:
        yield
    except KeyboardInterrupt:
        report()
        raise


def turns(watch: "Watch", topics: Sequence[str], timeout: float | None) -> Iterator[Turn]:
    """Listen to topics; a report is due once a second and at the end of a log.

    Args:
        watch: The bus.
        topics: The topics as typed.
        timeout: How long to wait for the first message [s]; None for without end.

    Raises:
        NothingReceived: No message came within ``timeout``.
    """
    _subscribe(watch, topics)
    try:
        yield from _pulled(watch, topics, timeout)
    except EOFError:  # the log has ended
        yield Turn(is_due=True)


def _subscribe(watch: "Watch", topics: Sequence[str]) -> None:
    graph = ask_nodes(watch)
    watch.listen_to([spelling for topic in topics for spelling in topic_spellings(topic)])
    for topic in topics:
        talk(f"subscribed to [{known_spelling(graph, topic) or topic_spellings(topic)[-1]}]")


def _pulled(watch: "Watch", topics: Sequence[str], timeout: float | None) -> Iterator[Turn]:
    spellings = {topic: set(topic_spellings(topic)) for topic in topics}
    silent = set(topics)
    start = time.monotonic()
    report = start + _REPORT_PERIOD
    give_up = math.inf if timeout is None else start + timeout
    while True:
        until = report if len(silent) < len(topics) else min(report, give_up)
        packets = watch.receive(max(0.0, until - time.monotonic()))
        arrivals = tuple(
            (topic, packet)
            for packet in packets
            for topic, channels in spellings.items()
            if packet.channel in channels
        )
        silent.difference_update(topic for topic, _ in arrivals)
        now = time.monotonic()
        if now >= give_up and len(silent) == len(topics):
            raise NothingReceived(f"nothing came on {', '.join(topics)} within {timeout:g} s")
        yield Turn(arrivals, is_due=now >= report)
        if now >= report:
            report += _REPORT_PERIOD
            if _PATIENCE <= now - start < _PATIENCE + _REPORT_PERIOD:
                _tell(watch, [topic for topic in topics if topic in silent])


def _tell(watch: "Watch", silent: Sequence[str]) -> None:
    """Say on which topics nothing has come, and what may have been meant."""
    command = click.get_current_context().command_path
    for topic in silent:
        talk(f"{command}: no message on {topic} yet; {near_topic(watch.graph(), topic)}")
