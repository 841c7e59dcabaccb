"""What a launch file asks for, as frozen values: processes, arguments and what to say about it.

Belongs here: the values only. How they are read from files, and how they are run, is elsewhere.
"""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum


class Output(Enum):
    """Where the lines of a process go; errors are on the screen always."""

    SCREEN = "screen"
    LOG = "log"
    BOTH = "both"


@dataclass(frozen=True, slots=True)
class NodePlan:
    """A process that is to be run.

    Attributes:
        name: The node's full name ("/husky0/driver").
        command: The command line, as somebody would type it.
        place: Where it was written ("robot.launch:3").
        environment: Variables that it gets besides the launcher's own.
        directory: Its working directory; "" for the launcher's.
        output: Where its lines go.
        respawn: Whether it is started again when it ends.
        respawn_delay: Seconds until then.
        is_required: Whether its end is the end of all.
        takes_input: Whether it reads the launcher's standard input.
        takes_terminal: Whether it has the launcher's input and output for its own.
    """

    name: str
    command: tuple[str, ...]
    place: str
    environment: Mapping[str, str] = field(default_factory=dict)
    directory: str = ""
    output: Output = Output.LOG
    respawn: bool = False
    respawn_delay: float = 0.0
    is_required: bool = False
    takes_input: bool = False
    takes_terminal: bool = False

    def command_line(self) -> str:
        """What one types into a shell to run it alone."""
        variables = [f"{name}={shlex.quote(text)}" for name, text in self.environment.items()]
        line = " ".join([*variables, shlex.join(self.command)])
        return f"cd {shlex.quote(self.directory)} && {line}" if self.directory else line


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a launch file.

    Attributes:
        name: Its name, as in ``name:=value``.
        default: As written, before anything is put in; None where a value must be given.
        doc: What it is for, or "".
    """

    name: str
    default: str | None
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Plan:
    """What launch files ask for, all together.

    Attributes:
        nodes: The processes in the order of the files.
        files: The files that were read, the included ones too.
        notes: What a person should know of: things that mean nothing here, each with its place.
    """

    nodes: tuple[NodePlan, ...]
    files: tuple[str, ...]
    notes: tuple[str, ...] = ()
