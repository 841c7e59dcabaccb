"""Checking a lab: which program is checked by what, on which stage."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import Lab, Role
from lcmtools.labs.checks import dolly, husky, pioneer
from lcmtools.labs.checks.programs import split_command
from lcmtools.labs.checks.row import Row
from lcmtools.labs.checks.stage import Stage

Check = Callable[[Stage, Sequence[str]], Iterator[Row]]

CHECKS: Mapping[str, Check] = {
    "controller": husky.check_controller,
    "evaluator": husky.check_evaluator,
    "teleop": pioneer.check_teleop,
    "viewer": pioneer.check_viewer,
    "mover": dolly.check_mover,
    "reader": dolly.check_reader,
}
"""By the role's option."""

FAST = 4.0
"""Times real time at which our own programs are checked: they go by the odometry's time."""
_REAL = 1.0
_ALWAYS_FAST = ("mover", "reader", "evaluator")  # what is measured does not depend on it


def choose(lab: Lab, programs: Mapping[str, str]) -> list[tuple[Role, list[str], bool]]:
    """The subject of a check: the role, the command line, and whether it is our own.

    Args:
        lab: The lab.
        programs: The student's command lines by role; of none, ours are checked, all of them.

    Raises:
        UsageError: A role is of another lab, or a command line is wrong.
    """
    known = {role.option: role for role in lab.roles}
    for option in programs:
        if option not in known:
            hint = ", ".join(f"--{name}" for name in known)
            raise UsageError(f"--{option} is no program of the lab {lab.name}", f"it has {hint}")
    if not programs:
        return [(role, [*role.own, *role.arguments], True) for role in lab.roles]
    return [
        (known[option], command_of(known[option], text), False) for option, text in programs.items()
    ]


def command_of(role: Role, text: str) -> list[str]:
    """A student's command line, with the names that connect it unless it has some of its own.

    Raises:
        UsageError: It is empty, or a quotation mark is missing.
    """
    words = split_command(text)
    return words if any(":=" in word for word in words) else [*words, *role.arguments]


def check(
    lab: Lab, programs: Mapping[str, str], rate: float | None = None
) -> Iterator[tuple[Role, Row]]:
    """Check programs one after the other, each on a stage of its own.

    Args:
        lab: The lab.
        programs: The student's command lines by role; of none, ours are checked.
        rate: Times real time; None for what suits: a student's controller may go by the real
            clock, and is given real time.

    Raises:
        UsageError: A role is of another lab, or a program cannot be started.
        LcmtoolsError: The simulator does not start.
    """
    for role, words, is_ours in choose(lab, programs):
        suits = FAST if is_ours or role.option in _ALWAYS_FAST else _REAL
        with Stage(lab, rate or suits) as stage:
            for found in CHECKS[role.option](stage, words):
                yield role, found
