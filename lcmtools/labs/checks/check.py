"""Checking a lab: the check of each program, on a test bench of its own."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import Lab, Role
from lcmtools.labs.checks import dolly, husky, pioneer
from lcmtools.labs.checks.programs import CheckResult, split_command
from lcmtools.labs.checks.test_bench import TestBench

Check = Callable[[TestBench, Sequence[str]], Iterator[CheckResult]]

CHECKS: Mapping[str, Check] = {
    "controller": husky.check_controller,
    "evaluator": husky.check_evaluator,
    "teleop": pioneer.check_teleop,
    "viewer": pioneer.check_viewer,
    "mover": dolly.check_mover,
    "reader": dolly.check_reader,
}
"""By the role's option."""

_FAST, _REAL = 4.0, 1.0  # simulated seconds per second
_ALWAYS_FAST = ("mover", "reader", "evaluator")  # what is measured does not depend on it


def choose(lab: Lab, programs: Mapping[str, str]) -> list[tuple[Role, list[str], float]]:
    """Return the roles to be checked, each with a command line and a simulator's rate.

    A student's controller may go by the real clock, and gets real time; the model answers go by the
    odometry's. The lab's names are added unless a command line has some of its own.

    Args:
        lab: The lab.
        programs: The student's command lines by role; of none, the model answers are checked.

    Raises:
        UsageError: A role is of another lab, or a command line is wrong.
    """
    known = {role.option: role for role in lab.roles}
    if not programs:
        return [(role, [*role.answer, *role.arguments], _FAST) for role in lab.roles]
    chosen = []
    for option, text in programs.items():
        if option not in known:
            hint = ", ".join(f"--{name}" for name in known)
            raise UsageError(f"--{option} is no program of the lab {lab.name}", f"it has {hint}")
        words = split_command(text)
        if not any(":=" in word for word in words):
            words += known[option].arguments
        chosen.append((known[option], words, _FAST if option in _ALWAYS_FAST else _REAL))
    return chosen


def check(
    lab: Lab, programs: Mapping[str, str], rate: float | None = None
) -> Iterator[tuple[Role, CheckResult]]:
    """Check programs one after the other, each on a test bench of its own.

    Args:
        lab: The lab.
        programs: The student's command lines by role; of none, the model answers are checked.
        rate: Simulated seconds per second; None for what suits each.

    Raises:
        UsageError: A role is of another lab, or a program cannot be started.
        LcmtoolsError: The simulator does not start.
    """
    for role, words, suitable in choose(lab, programs):
        with TestBench(lab, rate or suitable) as bench:
            for result in CHECKS[role.option](bench, words):
                yield role, replace(result, hint="") if result.is_ok else result
