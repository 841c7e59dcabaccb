"""The rows of a node that evaluates a controller: its count, its errors and their average. Pure.

A test bench knows the velocities that each of its messages is of; in a log they are among the last
ones that were recorded before it.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from lcmtools.labs.checks.error_statistics import (
    OF_ERRORS,
    Velocity,
    average_cause,
    average_hint,
    error_cause,
    error_hint,
    root_mean_square,
    wrong_average,
)
from lcmtools.labs.checks.results import CheckResult
from lcmtools.types.air_lab0 import ControllerEvaluationStat

_MOST = 0.95  # of the samples: those around a change of the desired velocity may be of either
_REMEMBERS = "average_error remembers"
_LOST = ", unless the recorder lost messages (see lcmtools bag info)"


@dataclass(frozen=True, slots=True)
class Sample:
    """A message of an evaluator, with the desired and measured velocities that it may be of."""

    stat: ControllerEvaluationStat
    inputs: Sequence[tuple[Velocity, Velocity]]  # the likeliest last

    @property
    def difference(self) -> Velocity:
        """Desired minus measured velocity, of the inputs that fit the error best."""
        differences = [(v[0] - u[0], v[1] - u[1]) for v, u in reversed(self.inputs)]
        return min(differences, key=lambda one: abs(math.hypot(*one) - self.stat.last_error))

    @property
    def is_right(self) -> bool:
        """True if its error is that of its inputs."""
        wanted = math.hypot(*self.difference)
        return math.isclose(self.stat.last_error, wanted, rel_tol=0.02, abs_tol=0.005)


def samples_row(stats: Sequence[ControllerEvaluationStat], *, is_log: bool = False) -> CheckResult:
    """Return the row for the numbers of samples, of two messages or more, or of a log."""
    steps = {after.samples - now.samples for now, after in pairwise(stats)}
    hint = "count in the odometry callback, and only there: one message for each odometry"
    if stats[0].samples < 1:
        hint = "count a sample before you publish it: the first message is of 1 sample"
    elif min(steps, default=0) < 0:
        hint = "it starts again: go on counting when another desired velocity comes"
    elif is_log:
        hint += _LOST
    measured = f"{stats[0].samples} to {stats[-1].samples} in {len(stats)} messages"
    is_ok = steps <= {1} and stats[0].samples >= 1
    return CheckResult("samples", "1 more each time", measured, is_ok, hint)


def error_row(what: str, samples: Sequence[Sample]) -> CheckResult:
    """Return the row for the errors in some messages; shown is the last one, or a wrong one."""
    wrong = [sample for sample in samples if not sample.is_right]
    right = len(samples) - len(wrong)
    is_ok = right >= _MOST * len(samples)
    shown = samples[-1] if is_ok else wrong[-1]
    measured = f"{shown.stat.last_error:.3f}"
    if len(samples) > 1:
        measured += f", {right} of {len(samples)} right"
    cause = "" if is_ok else error_cause(shown.stat.last_error, *shown.inputs[-1])
    wanted = f"{math.hypot(*shown.difference):.3f}"
    return CheckResult(what, wanted, measured, is_ok, error_hint(cause), cause or what)


def average_rows(samples: Sequence[Sample], change: int = 0) -> Iterator[CheckResult]:
    """Yield the rows for the average from its first sample on, before and after a change."""
    averages = [sample.stat.average_error for sample in samples]
    differences = [sample.difference for sample in samples]
    wrong = wrong_average(averages, differences)
    cause = "" if wrong is None else average_cause(averages, differences)
    hint, key = average_hint(cause), cause.removeprefix(OF_ERRORS) or "average"
    parts = ("average_error", 0, change), (_REMEMBERS, change, len(samples))
    for what, start, end in parts[not change :]:
        is_ok = wrong is None or not start <= wrong < end
        index = end - 1 if is_ok or wrong is None else wrong
        wanted = root_mean_square([math.hypot(*one) for one in differences[: index + 1]])
        measured = f"{averages[index]:.3f} of {index + 1} samples"
        yield CheckResult(what, f"{wanted:.3f}", measured, is_ok, hint, key)


def log_rows(samples: Sequence[Sample]) -> Iterator[CheckResult]:
    """Yield the rows for the messages in a log, which may begin late and lack some."""
    stats = [sample.stat for sample in samples]
    errors = error_row("last_error", samples)
    yield samples_row(stats, is_log=True)
    yield errors
    if errors.is_ok and [stat.samples for stat in stats] == list(range(1, len(stats) + 1)):
        yield from average_rows(samples)
        return
    pairs = [(a, b) for a, b in pairwise(stats) if b.samples == a.samples + 1]
    right = sum(_includes(before, after) for before, after in pairs)
    wanted, measured = "each includes one more error", f"{right} of {len(pairs)}"
    key = "average" if errors.is_ok else errors.cause
    is_ok = right == len(pairs)
    yield CheckResult(_REMEMBERS, wanted, measured, is_ok, average_hint(""), key)


def _includes(before: ControllerEvaluationStat, after: ControllerEvaluationStat) -> bool:
    """Return True if the mean of the squares includes the last error."""
    return math.isclose(
        after.samples * after.average_error**2,
        before.samples * before.average_error**2 + after.last_error**2,
        rel_tol=1e-6,
        abs_tol=1e-9,
    )
