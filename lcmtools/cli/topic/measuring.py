"""Measuring topics over windows of messages: the loop that hz, bw and delay share.

Belongs here: when a report is made, and when it is the last. Must not know what is measured.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Protocol, TypeVar

import click

from lcmtools.cli.options import duration, whole_number
from lcmtools.cli.output import talk
from lcmtools.observe.arrival import Arrival
from lcmtools.observe.batches import Batch

CommandT = TypeVar("CommandT", bound=Callable[..., object])
FoundT_co = TypeVar("FoundT_co", covariant=True)
FoundT = TypeVar("FoundT")


class Meter(Protocol[FoundT_co]):
    """What is measured of one topic."""

    def add(self, arrival: Arrival) -> None:
        """Take a message into account."""
        ...

    def take(self, now: int) -> FoundT_co | None:
        """What was found at a time [ns]; None when there is nothing new to say."""
        ...

    def clear(self) -> None:
        """Forget all: times begin anew."""
        ...


def measure(
    source: Iterator[Batch],
    meters: Mapping[str, Meter[FoundT]],
    report: Callable[[Mapping[str, FoundT | None]], None],
    count: int | None,
) -> None:
    """Report whenever it is due, and once more when Ctrl-C ends it.

    Args:
        source: What comes.
        meters: One for each topic.
        report: Prints what was found, by topic.
        count: After how many reports that had something to say to return; None for never.

    Raises:
        KeyboardInterrupt: Ctrl-C, after the last report.
    """
    reports = 0
    now = 0
    try:
        for turn in source:
            now = turn.now
            _feed(turn, meters)
            if turn.is_due:
                found = {topic: meter.take(now) for topic, meter in meters.items()}
                if any(found.values()) or not turn.is_last:
                    report(found)
                reports += any(found.values())
                if reports == count:
                    return
    except KeyboardInterrupt:
        found = {topic: meter.take(now) for topic, meter in meters.items()}
        if any(found.values()):
            report(found)
        raise


def measuring_options(command: CommandT) -> CommandT:
    """Add ``--timeout``, ``-n`` and ``--wall-time``, which are a ``turns.How``."""
    timeout = click.option(
        "--timeout", type=duration, help="Give up (exit code 4) when none comes so long."
    )
    count = click.option(
        "-n", "count", metavar="N", type=whole_number(1), help="Stop after so many reports."
    )
    wall_time = click.option(
        "--wall-time", is_flag=True, help="Go by real time where a simulator publishes /clock."
    )
    return timeout(count(wall_time(command)))


def window_option(*, least: int, usual: int) -> Callable[[CommandT], CommandT]:
    """Add ``--window``.

    Args:
        least: The smallest window, in messages.
        usual: The window where none is given.
    """
    return click.option(
        "-w",
        "--window",
        metavar="N",
        type=whole_number(least),
        default=usual,
        show_default=True,
        help="Messages to average over.",
    )


def _feed(turn: Batch, meters: Mapping[str, Meter[FoundT]]) -> None:
    if turn.is_reset:
        talk("time has reset, resetting counters")
        for meter in meters.values():
            meter.clear()
    for arrival in turn.arrivals:
        meters[arrival.topic].add(arrival)
