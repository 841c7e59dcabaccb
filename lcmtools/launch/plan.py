"""A plan, the meaning of launch files as frozen values: processes, arguments and notes."""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from lcmtools.errors import UsageError
from lcmtools.names import base_name_of, did_you_mean


class Output(Enum):
    """The place for the lines of a process; errors are always on the screen."""

    SCREEN = "screen"
    LOG = "log"
    BOTH = "both"


@dataclass(frozen=True, slots=True)
class NodePlan:
    """A process that is to be run.

    Attributes:
        name: The node's full name ("/husky0/driver").
        command: The command line, as a user would type it.
        place: File and line ("robot.launch:3").
        parameters: Those on the command line, name to YAML text.
        environment: Variables besides the launcher's own.
        directory: Its working directory; "" for the launcher's.
        output: The place for its lines.
        respawn: It is started again when it ends.
        respawn_delay: Seconds until then.
        is_required: Its end is the end of all.
        takes_input: It reads the launcher's standard input.
        takes_terminal: It has the launcher's standard input and output for its own.
    """

    name: str
    command: tuple[str, ...]
    place: str
    parameters: Mapping[str, str] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    directory: str = ""
    output: Output = Output.LOG
    respawn: bool = False
    respawn_delay: float = 0.0
    is_required: bool = False
    takes_input: bool = False
    takes_terminal: bool = False

    def command_line(self) -> str:
        """Return the line that runs it alone in a shell."""
        variables = [f"{name}={shlex.quote(text)}" for name, text in self.environment.items()]
        line = " ".join([*variables, shlex.join(self.command)])
        return f"cd {shlex.quote(self.directory)} && {line}" if self.directory else line


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a launch file: its name, its default as written, its description.

    Without a default (None) a value must be given.
    """

    name: str
    default: str | None
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Plan:
    """The meaning of launch files, all together.

    Attributes:
        nodes: The processes in the order of the files.
        files: The files that were read, the included ones too.
        notes: Things that have no meaning here, each with its place.
    """

    nodes: tuple[NodePlan, ...]
    files: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def find(self, name: str) -> NodePlan:
        """Return a node by its full name, or by the last part of it if that is enough.

        Raises:
            UsageError: There is none, or several.
        """
        full = [node for node in self.nodes if node.name == f"/{name.strip('/')}"]
        found = full or [node for node in self.nodes if base_name_of(node.name) == name]
        if len(found) == 1:
            return found[0]
        if found:
            names = ", ".join(node.name for node in found)
            raise UsageError(f"several nodes are called '{name}'", f"write one of {names}")
        known = [node.name for node in self.nodes]
        hint = did_you_mean(name, known) or f"there are {', '.join(known) or 'none'}"
        raise UsageError(f"there is no node '{name}' in the launch file", hint)
