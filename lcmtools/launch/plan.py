"""A plan: the content of launch files as frozen values: processes, arguments and notes."""

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
    """A process to be run."""

    name: str  # the node's full name ("/husky0/driver")
    command: tuple[str, ...]  # the command line, as a user would type it
    place: str  # file and line ("robot.launch:3")
    parameters: Mapping[str, str] = field(default_factory=dict)  # checked, name to YAML text
    environment: Mapping[str, str] = field(default_factory=dict)  # added to the launcher's
    directory: str = ""  # its working directory; "" for the launcher's
    output: Output = Output.LOG  # the place for its lines
    respawn: bool = False  # True if it is started again when it ends
    respawn_delay: float = 0.0  # seconds until then
    is_required: bool = False  # True if its end ends all nodes
    takes_input: bool = False  # True if it reads the launcher's standard input
    takes_terminal: bool = False  # True if it uses the launcher's standard input and output

    def command_line(self) -> str:
        """Return the line to run it alone in a shell."""
        variables = [f"{name}={shlex.quote(text)}" for name, text in self.environment.items()]
        line = " ".join([*variables, shlex.join(self.command)])
        return f"cd {shlex.quote(self.directory)} && {line}" if self.directory else line


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """An argument of a launch file."""

    name: str
    default: str | None  # as written; if it is None, a value must be given
    doc: str = ""  # its description


@dataclass(frozen=True, slots=True)
class Plan:
    """The combined content of launch files."""

    nodes: tuple[NodePlan, ...]  # the processes in the order of the files
    files: tuple[str, ...]  # the files that were read, including the included ones
    notes: tuple[str, ...] = ()  # parts that have no meaning here, each with its place

    def find(self, name: str) -> NodePlan:
        """Find a node by its full name or its last part; UsageError unless there is exactly one."""
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
