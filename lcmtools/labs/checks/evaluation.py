"""A node that evaluates a controller: its rows, the right formulas and common mistakes. Pure.

An error is the length of the difference of two velocities; the average is the root of the mean of
the squares of all errors. A test bench knows the velocities that each message is of; in a log they
are among the last ones that were recorded before it.
"""

import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

from lcmtools.labs.checks.diagnosis import explain_number
from lcmtools.labs.checks.results import CheckResult
from lcmtools.types.air_lab0 import ControllerEvaluationStat

_OF_ERRORS = "the root of the mean square of "
"""The beginning of the text of an average that is right, but of wrong errors."""
Velocity = tuple[float, float]
"""linear.x [m/s], angular.z [rad/s]."""

_REST = (0.0, 0.0)
_MOST = 0.95  # of the samples: those around a change of the desired velocity may be of either
_REMEMBERS = "average_error remembers"
_LOST = ", unless the recorder lost messages (see lcmtools bag info)"
_CLOSE, _NEAR = 0.005, 0.001  # relative and absolute, of two averages that are the same
_LONGEST = 100  # samples that are compared with each formula
_ERROR = "the root of (v - desired v)^2 + (w - desired w)^2"
_AVERAGE = "the root of the mean of the squares of all errors"

_ERRORS: Mapping[str, Callable[[float, float], float]] = {
    "always 0": lambda *_: 0.0,
    "the square, without the root": lambda v, w: v * v + w * w,
    "the error of linear.x only": lambda v, _: abs(v),
    "the error of angular.z only": lambda _, w: abs(w),
    "the sum |v - desired v| + |w - desired w|": lambda v, w: abs(v) + abs(w),
    "the negative error": lambda v, w: -math.hypot(v, w),
    "the negative error of linear.x only": lambda v, _: -abs(v),
    "the negative error of angular.z only": lambda _, w: -abs(w),
    "the mean of both errors": lambda v, w: (abs(v) + abs(w)) / 2,
    "the root of the mean of both squares": lambda v, w: math.sqrt((v * v + w * w) / 2),
}
"""Mistakes in the error, by the differences of linear.x and angular.z."""
_INPUTS: Mapping[str, Callable[[Velocity, Velocity], Velocity]] = {
    "the length of the desired velocity, without the measured one": lambda desired, _: desired,
    "the length of the measured velocity, without the desired one": lambda _, actual: actual,
    "made of the sum of both velocities, not of their difference": (
        lambda desired, actual: (desired[0] + actual[0], desired[1] + actual[1])
    ),
    "made with linear.x and angular.z exchanged": (
        lambda desired, actual: (desired[0] - actual[1], desired[1] - actual[0])
    ),
}
"""Mistakes in the difference of a desired and an actual velocity."""


def _running(step: Callable[[float, float, int], float]) -> Callable[[Sequence[float]], float]:
    """Return an average that is computed from the one before, an error and its number."""

    def average(errors: Sequence[float]) -> float:
        value = 0.0
        for number, error in enumerate(errors, 1):
            value = step(value, error, number)
        return value

    return average


def _mean_square(errors: Sequence[float]) -> float:
    return statistics.fmean(error * error for error in errors)


def root_mean_square(errors: Sequence[float]) -> float:
    """Return the average that the lab asks for, of one error or more."""
    return math.sqrt(_mean_square(errors))


_AVERAGES: Mapping[str, Callable[[Sequence[float]], float]] = {
    "the mean of the errors": statistics.fmean,
    "the mean of the squares, without the root": _mean_square,
    "the sum, not divided by the samples": math.fsum,
    "the sum of the squares, without the mean and the root": (
        lambda errors: len(errors) * _mean_square(errors)
    ),
    "the root of the sum of the squares, not of their mean": lambda errors: math.hypot(*errors),
    "the root of the sum of the squares, divided by the samples outside of the root": (
        lambda errors: math.hypot(*errors) / len(errors)
    ),
    "divided by the samples minus 1": (
        lambda errors: math.hypot(*errors) / math.sqrt(max(1, len(errors) - 1))
    ),
    "divided by the samples plus 1": lambda errors: (
        math.hypot(*errors) / math.sqrt(len(errors) + 1)
    ),
    "the last error alone": lambda errors: errors[-1],
    "the last error, divided by the samples": lambda errors: errors[-1] / len(errors),
    "the greatest error": max,
    "the standard deviation": statistics.pstdev,
    "the root of the mean of the errors": lambda errors: math.sqrt(statistics.fmean(errors)),
    "the mean of the last average and the newest error": (
        _running(lambda value, error, _: (value + error) / 2)
    ),
    "the last average and the newest error, divided by the samples": (
        _running(lambda value, error, number: (value + error) / number)
    ),
}
"""Mistakes in the average, by all errors so far."""


def error_cause(measured: float, desired: Velocity, actual: Velocity = _REST) -> str:
    """Return the wrong formula that gives the measured error; "" if none does."""
    difference = desired[0] - actual[0], desired[1] - actual[1]
    formulas = {text: error(*difference) for text, error in _ERRORS.items()}
    others = {text: math.hypot(*of(desired, actual)) for text, of in _INPUTS.items()}
    return explain_number(measured, {**formulas, **others})


def _error_hint(cause: str) -> str:
    """Return a hint: the formula of the error, and the one used in its place if known."""
    return f"it is {cause}, and should be {_ERROR}" if cause else _ERROR


def _average_hint(cause: str) -> str:
    """Return a hint: the formula of the average, and the one used in its place if known."""
    return f"it is {cause}, and should be {_AVERAGE}" if cause else f"it should be {_AVERAGE}"


def wrong_averages(averages: Sequence[float], differences: Sequence[Velocity]) -> list[int]:
    """Return the indices of the averages that are not the root mean square."""
    sums = accumulate(v * v + w * w for v, w in differences)
    wanted = (math.sqrt(total / count) for count, total in enumerate(sums, 1))
    agree = map(_are_same, averages, wanted)
    return [index for index, is_right in enumerate(agree) if not is_right]


def average_cause(averages: Sequence[float], differences: Sequence[Velocity]) -> str:
    """Return the wrong formula that gives the averages; "" if none does.

    ``differences`` are those of the desired and the measured velocity, one for each average.
    """
    averages = averages[:_LONGEST]
    for text, errors, statistic in _mistakes(differences[:_LONGEST]):
        expected = [statistic(errors[: index + 1]) for index in range(len(averages))]
        # the first one is often a special case, as there is no division by 0
        if all(map(_are_same, averages[1:], expected[1:])):
            return text
    return ""


def _mistakes(
    differences: Sequence[Velocity],
) -> Iterator[tuple[str, Sequence[float], Callable[[Sequence[float]], float]]]:
    """Yield mistakes: in the average, in the errors, and in both."""
    right = [math.hypot(*difference) for difference in differences]
    wrong = {text: [error(*one) for one in differences] for text, error in _ERRORS.items()}
    yield "always 0", wrong["always 0"], max
    for text, statistic in _AVERAGES.items():
        yield text, right, statistic
    for text, errors in wrong.items():
        yield f"{_OF_ERRORS}{text}", errors, root_mean_square
    for text, errors in wrong.items():
        yield f"the mean of {text}", errors, statistics.fmean


def _are_same(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=_CLOSE, abs_tol=_NEAR)


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
    return CheckResult(what, wanted, measured, is_ok, _error_hint(cause), cause or what)


def average_rows(samples: Sequence[Sample], change: int = 0) -> Iterator[CheckResult]:
    """Yield the rows for the average from its first sample on, before and after a change."""
    averages = [sample.stat.average_error for sample in samples]
    differences = [sample.difference for sample in samples]
    wrong = wrong_averages(averages, differences)
    cause = average_cause(averages, differences) if wrong else ""
    hint, key = _average_hint(cause), cause.removeprefix(_OF_ERRORS) or "average"
    parts = ("average_error", 0, change), (_REMEMBERS, change, len(samples))
    for what, start, end in parts[not change :]:
        index = next((one for one in wrong if start <= one < end), end - 1)
        is_ok = index not in wrong
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
    yield CheckResult(_REMEMBERS, wanted, measured, is_ok, _average_hint(""), key)


def _includes(before: ControllerEvaluationStat, after: ControllerEvaluationStat) -> bool:
    """Return True if the mean of the squares includes the last error."""
    return math.isclose(
        after.samples * after.average_error**2,
        before.samples * before.average_error**2 + after.last_error**2,
        rel_tol=1e-6,
        abs_tol=1e-9,
    )
