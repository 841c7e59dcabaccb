"""The tables of two command lines beside each other: what is told of each pair of commands."""

import re
from collections.abc import Sequence
from functools import partial

from commands import Flow, Run, middle

ENDED = ["command", "ms", "theirs", "ratio", "CPU ms", "theirs", "ratio", "found", "failed"]
FLOWING = [
    "message",
    "printed/s",
    "theirs",
    "ratio",
    "CPU %",
    "theirs",
    "us",
    "theirs",
    "ratio",
]
RATES = ["stream", "CPU %", "theirs", "ratio", "off by", "theirs"]


def ended_cells(ours: Sequence[Run], theirs: Sequence[Run], named: str) -> list[object]:
    """Wall and processor time [ms], how many topics each named in the end, and how many failed.

    Args:
        ours: Our runs.
        theirs: The others'.
        named: A pattern that matches a topic's name.
    """
    cells: list[object] = []
    for value in (_wall, _processor):
        a, b = (1000 * middle(side, value) for side in (ours, theirs))
        cells += [a, b, b / a]
    found = [str(len(set(re.findall(named, side[-1].output)))) for side in (ours, theirs)]
    failed = [str(sum(one.code != 0 for one in side)) for side in (ours, theirs)]
    return [*cells, ", ".join(found), ", ".join(failed)]


def flow_cells(ours: Sequence[Flow], theirs: Sequence[Flow]) -> list[object]:
    """Messages printed a second, share of a core, and processor time for one message."""
    rates = [middle(side, lambda flow: flow.rate) for side in (ours, theirs)]
    shares = [middle(side, lambda flow: flow.share) for side in (ours, theirs)]
    costs = [middle(side, lambda flow: flow.cost) for side in (ours, theirs)]
    return [*rates, rates[0] / rates[1], *shares, *costs, costs[1] / costs[0]]


def rate_cells(
    true: float, sides: Sequence[Sequence[Flow]], patterns: Sequence[str]
) -> list[object]:
    """Share of a core, and how far the rates told are from the true one.

    Args:
        true: That one [Hz].
        sides: What was watched: ours, and theirs.
        patterns: The pattern of the rate in the output of each.
    """
    shares = [middle(side, lambda flow: flow.share) for side in sides]
    told = [
        middle(side, partial(_told, pattern)) for side, pattern in zip(sides, patterns, strict=True)
    ]
    return [*shares, shares[1] / shares[0], *(f"{100 * abs(one / true - 1):.1f} %" for one in told)]


def _told(pattern: str, flow: Flow) -> float:
    """The rate that a command told last [Hz]."""
    return float(re.findall(pattern, flow.output)[-1])


def _wall(one: Run) -> float:
    return one.wall


def _processor(one: Run) -> float:
    return one.processor
