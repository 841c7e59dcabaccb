"""The programs under test: their start on the private bus, their ends and their last lines."""

import os
import shlex
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType, TracebackType
from typing import NamedTuple, Protocol, TypeAlias

from lcmtools.bus.base import LOCKSTEP
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.node import process
from lcmtools.node.node import Node
from lcmtools.node.spinning import spin_in_background
from lcmtools.packages.programs import RUN, python_command, startable
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_PATIENCE = StopTimeouts(interrupt=5.0, terminate=2.0)
_LAST_BYTES, _LAST_LINES = 4000, 8


class Program(Protocol):
    """A program to be run, such as a ``NodePlan`` of a launch file."""

    @property
    def name(self) -> str:
        """Its name in reports."""

    @property
    def command(self) -> Sequence[str]:
        """The words of its command line."""

    @property
    def environment(self) -> Mapping[str, str]:
        """Variables in addition to those of this process."""

    @property
    def directory(self) -> str:
        """Its working directory; "" for this process's."""


class Command(NamedTuple):
    """A program that is given by its command line."""

    command: Sequence[str]

    @property
    def name(self) -> str:
        """The command line, in short."""
        return shlex.join(self.command)

    environment: Mapping[str, str] = MappingProxyType({})
    directory: str = ""


TestedPrograms: TypeAlias = Sequence[Program] | type[Node]
"""The programs under test, or a class of nodes, of which one is made in this process."""


def tested(program: str | Sequence[str] | TestedPrograms) -> TestedPrograms:
    """Return the programs for a class, a command line, its words, or programs.

    Raises:
        UsageError: It is none of these.
    """
    if isinstance(program, str):
        program = shlex.split(program)
    if isinstance(program, type) and issubclass(program, Node):
        return program
    if isinstance(program, type) or not program:
        what = f"a program is a command line or a class of nodes, not {program!r}"
        raise UsageError(what, 'write for example "lcmtools run talker"')
    words = [word for word in program if isinstance(word, str)]
    if len(words) == len(program):
        return [Command(words)]
    return [one for one in program if not isinstance(one, str)]


def named(program: TestedPrograms) -> str:
    """Return the names of programs."""
    if isinstance(program, type):
        return program.__name__
    return ", ".join(one.name for one in program)


class NodeHere(AbstractContextManager["NodeHere"]):
    """A node in this process, made from its class; a substitute for ``Programs``."""

    def __init__(self, cls: type[Node], variables: Mapping[str, str], words: Sequence[str]) -> None:
        self._cls, self._variables, self._words = cls, variables, words

    def __enter__(self) -> "NodeHere":
        """Make the node, and run its callbacks on a thread."""
        before = os.environ.get(LOCKSTEP)
        try:
            if LOCKSTEP in self._variables:
                os.environ[LOCKSTEP] = self._variables[LOCKSTEP]
            process.init(self._words, url=self._variables["LCM_DEFAULT_URL"], handle_signals=False)
        finally:
            os.environ.pop(LOCKSTEP, None)
            if before is not None:
                os.environ[LOCKSTEP] = before
        try:
            spin_in_background(self._cls())  # type: ignore[call-arg] # a user's class has a name
        except BaseException:
            process.shutdown()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """End the node."""
        process.shutdown()

    def __len__(self) -> int:
        """Return 1: the node."""
        return 1

    def ended(self, timeout: float = 0.0) -> str:
        """Return a sentence if the node has ended; "" while it runs."""
        del timeout
        return "" if process.ok() else f"{self._cls.__name__} ended"

    def last_lines(self) -> tuple[str, ...]:
        """Return nothing, because its lines have been printed here."""
        return ()


class RunningPrograms(Protocol):
    """What a session needs to know of the programs."""

    def __len__(self) -> int:
        """Return their number."""

    def ended(self, timeout: float = 0.0) -> str:
        """Return a sentence on one that has ended, waiting for that if asked to; "" for none."""

    def last_lines(self) -> tuple[str, ...]:
        """Return the last lines that they have printed."""


class Programs(AbstractContextManager["Programs"]):
    """Running programs; at the end of the context they have ended, with all that they started.

    Raises:
        LcmtoolsError: One cannot be started.
    """

    def __init__(self, programs: Sequence[Program], variables: Mapping[str, str]) -> None:
        self._plans, self._variables = programs, variables
        self._children: list[tuple[Program, ChildProcess]] = []
        self._stack = ExitStack()

    def __enter__(self) -> "Programs":
        """Start them."""
        with ExitStack() as stack:
            folder = Path(stack.enter_context(TemporaryDirectory(prefix="lcmtools-rerun-")))
            guard = stack.enter_context(ProcessGuard())
            for number, plan in enumerate(self._plans):
                child = self._started(plan, folder / str(number), guard)
                self._children.append((plan, stack.enter_context(child)))
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End them."""
        self._stack.__exit__(kind, error, trace)

    def __len__(self) -> int:
        """Return their number."""
        return len(self._plans)

    def ended(self, timeout: float = 0.0) -> str:
        """Return a sentence on one that has ended, waiting for that if asked to; "" for none."""
        for plan, child in self._children:
            if timeout:
                child.wait(timeout)
            if (code := child.code) is not None:
                how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
                return f"{plan.name} ended {how}"
        return ""

    def last_lines(self) -> tuple[str, ...]:
        """Return the last lines that they have printed."""
        found: list[str] = []
        for plan, child in self._children:
            lines = child.output(_LAST_BYTES).splitlines()[-_LAST_LINES:]
            mark = f"{plan.name}: " if len(self._children) > 1 else ""
            found += [f"{mark}{line}" for line in lines]
        return tuple(found)

    def _started(self, plan: Program, output: Path, guard: ProcessGuard) -> ChildProcess:
        command = _command(plan.command)
        variables = {**os.environ, "PYTHONUNBUFFERED": "1", **plan.environment, **self._variables}
        start = Start(
            command,
            variables,
            plan.directory,
            output=output,
            holds_interrupts=tuple(plan.command[: len(RUN)]) == RUN,
        )
        output.touch()
        try:
            return ChildProcess(start, guard, _PATIENCE)
        except OSError as error:
            what = f"cannot start {plan.command[0]}: {error.strerror}"
            raise LcmtoolsError(what, "write the program as in a shell") from None


def _command(words: Sequence[str]) -> list[str]:
    if not words:
        raise UsageError("there is no program to run", "write it after --")
    path = Path(words[0])
    if path.suffix == ".py" and path.is_file() and not os.access(path, os.X_OK):
        return [*python_command(path), *words[1:]]
    return startable(words)


def started(
    program: TestedPrograms, variables: Mapping[str, str], words: Sequence[str]
) -> AbstractContextManager[RunningPrograms]:
    """Return the programs, which start with the context and end with it.

    ``words`` are the arguments of a node in this process.
    """
    if isinstance(program, type):
        return NodeHere(program, variables, words)
    return Programs(program, variables)
