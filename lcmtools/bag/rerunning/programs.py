"""The programs under test: their start on the private bus, their ends and their last lines."""

import os
import shlex
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

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


@dataclass(frozen=True, slots=True)
class Program:
    """A program to be run; several are nodes of a launch file."""

    name: str
    command: Sequence[str]
    environment: Mapping[str, str] = field(default_factory=dict)  # beside this process's
    directory: str = ""  # its working directory; "" for this process's


@dataclass(frozen=True, slots=True)
class Tested:
    """The programs under test, or a class of nodes, of which one is made in this process."""

    programs: Sequence[Program] = ()
    node: type[Node] | None = None

    @property
    def name(self) -> str:
        """The names of all."""
        return self.node.__name__ if self.node else ", ".join(one.name for one in self.programs)


def tested(program: str | Sequence[str] | type[Node] | Tested) -> Tested:
    """Return what is to be tested, given as a class, a command line, its words, or as it is.

    Raises:
        UsageError: It is nothing of these.
    """
    if isinstance(program, Tested):
        return program
    if isinstance(program, type) and issubclass(program, Node):
        return Tested(node=program)
    if isinstance(program, type) or not program:
        what = f"a program is a command line or a class of nodes, not {program!r}"
        raise UsageError(what, 'write for example "lcmtools run talker"')
    words = shlex.split(program) if isinstance(program, str) else program
    return Tested([Program(shlex.join(words), words)])


class Programs(AbstractContextManager["Programs"]):
    """Running programs; at the end of the context they have ended, with all that they started.

    Raises:
        LcmtoolsError: One cannot be started.
    """

    def __init__(self, programs: Sequence[Program], variables: Mapping[str, str]) -> None:
        self._programs, self._variables = programs, variables
        self._children: list[tuple[Program, ChildProcess]] = []
        self._stack = ExitStack()
        self.count = max(1, len(programs))

    def __enter__(self) -> "Programs":
        """Start them."""
        with ExitStack() as stack:
            folder = Path(stack.enter_context(TemporaryDirectory(prefix="lcmtools-rerun-")))
            guard = stack.enter_context(ProcessGuard())
            for number, program in enumerate(self._programs):
                child = self._started(program, folder / str(number), guard)
                self._children.append((program, stack.enter_context(child)))
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        """End them."""
        self._stack.close()

    def ended(self, timeout: float = 0.0) -> str:
        """Return a sentence on one that has ended, waiting for that if asked to; "" for none."""
        for program, child in self._children:
            if timeout:
                child.wait(timeout)
            if (code := child.code) is not None:
                how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
                return f"{program.name} ended {how}"
        return ""

    def last_lines(self) -> list[str]:
        """Return the last lines that they have printed."""
        found: list[str] = []
        for program, child in self._children:
            mark = f"{program.name}: " if self.count > 1 else ""
            lines = child.output(_LAST_BYTES).splitlines()[-_LAST_LINES:]
            found += [f"{mark}{line}" for line in lines]
        return found

    def _started(self, program: Program, output: Path, guard: ProcessGuard) -> ChildProcess:
        is_run = tuple(program.command[: len(RUN)]) == RUN
        start = Start(
            _command(program.command),
            {**os.environ, "PYTHONUNBUFFERED": "1", **program.environment, **self._variables},
            program.directory,
            output=output,
            holds_interrupts=is_run,
        )
        output.touch()
        try:
            return ChildProcess(start, guard, _PATIENCE)
        except OSError as error:
            what = f"cannot start {program.command[0]}: {error.strerror}"
            raise LcmtoolsError(what, "write the program as in a shell") from None


class NodeHere(Programs):
    """A node in this process, whose callbacks run on a thread."""

    def __init__(self, cls: type[Node], variables: Mapping[str, str], words: Sequence[str]) -> None:
        super().__init__((), variables)
        self._cls, self._words = cls, words

    def __enter__(self) -> "NodeHere":
        """Make the node, and run its callbacks."""
        os.environ[LOCKSTEP] = self._variables.get(LOCKSTEP, "")
        try:
            process.init(self._words, url=self._variables["LCM_DEFAULT_URL"], handle_signals=False)
        finally:
            del os.environ[LOCKSTEP]
        self._stack.callback(process.shutdown)
        with ExitStack() as stack:
            stack.callback(self._stack.close)
            spin_in_background(self._cls())  # type: ignore[call-arg] # a user's class has a name
            stack.pop_all()
        return self

    def ended(self, timeout: float = 0.0) -> str:
        """Return a sentence if the node has ended; "" while it runs."""
        del timeout
        return "" if process.ok() else f"{self._cls.__name__} ended"


def started(
    program: Tested, variables: Mapping[str, str], words: Sequence[str]
) -> AbstractContextManager[Programs]:
    """Return the programs, which run within the context; ``words`` are for a node here."""
    if program.node:
        return NodeHere(program.node, variables, words)
    return Programs(program.programs, variables)


def _command(words: Sequence[str]) -> list[str]:
    path = Path(words[0])
    if path.suffix == ".py" and path.is_file() and not os.access(path, os.X_OK):
        return [*python_command(path), *words[1:]]
    return startable(words)
