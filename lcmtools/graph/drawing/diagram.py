"""The values of a diagram: members of the bus, channels, and the relations between them.

Must not know the formats of diagrams.
"""

from dataclasses import dataclass
from enum import Enum

from lcmtools.graph.common_topics import LEFT_OUT_OF_DIAGRAMS
from lcmtools.names import is_hidden


class Relation(Enum):
    """A relation of a member to a channel or, where channels are not drawn, to a member."""

    PUBLISHES = "publishes"
    SUBSCRIBES = "subscribes"
    CALLS = "calls"
    SERVES = "serves"
    FEEDS = "feeds"


@dataclass(frozen=True, slots=True)
class Member:
    """A node, or a program that is not a node; texts are "" and numbers None if unknown."""

    id: str  # unique in its diagram, letters and digits: "n1"
    name: str  # a node's full name, or a program's command line
    host: str = ""  # its computer's name, or address if only that is known
    is_here: bool = True  # on this computer
    pid: int | None = None
    command: str = ""
    user: str = ""  # the process's owner
    is_node: bool = True  # False for a program that is only seen from outside
    is_tool: bool = False  # a command of lcmtools, such as echo or pub
    publishes: bool = False
    listens: bool = False  # True for a program that receives; LCM does not reveal its channels
    stale: str = ""  # the reason why a node counts as stale; "" for one that is alive

    @property
    def looks_on(self) -> bool:
        """True for a command that only observes."""
        return self.is_tool and not self.publishes

    @property
    def is_hidden(self) -> bool:
        """True if its name hides it; commands have hidden names, but pub takes part."""
        return self.is_node and is_hidden(self.name) and not (self.is_tool and self.publishes)

    @property
    def group(self) -> str:
        """Its outermost namespace; "" for none."""
        return outermost(self.name) if self.is_node else ""


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic, or a service."""

    id: str  # unique in its diagram: "t1", or "s1" for a service
    name: str
    types: tuple[str, ...] = ()  # as announced, else all that messages may have as seen
    is_service: bool = False
    messages: int = 0  # announced as sent, or observed
    rate: float | None = None  # [Hz], if measured
    shown: tuple[str, ...] = ()  # types as text, if these differ from ``types``

    @property
    def is_hidden(self) -> bool:
        """True if it is left out of lists."""
        return is_hidden(self.name)

    @property
    def is_quiet(self) -> bool:
        """True for a topic that nearly every node has."""
        return not self.is_service and self.name in LEFT_OUT_OF_DIAGRAMS

    @property
    def group(self) -> str:
        """Its outermost namespace; "" for none."""
        return outermost(self.name)

    @property
    def type_text(self) -> str:
        """Its types as one line."""
        return ", ".join(self.type_texts) or "unknown type"

    @property
    def type_texts(self) -> tuple[str, ...]:
        """Its types, each as text."""
        return self.shown or self.types


@dataclass(frozen=True, slots=True)
class Edge:
    """A flow of messages or calls."""

    source: str  # ids of both ends
    target: str
    relation: Relation  # the member's role
    messages: int = 0  # as counted by the member, or observed
    rate: float | None = None  # [Hz], if measured
    topics: tuple[str, ...] = ()  # the topics it replaces, if channels are not drawn


@dataclass(frozen=True, slots=True)
class Diagram:
    """The content of a picture; without channels, members are connected directly."""

    members: tuple[Member, ...] = ()
    channels: tuple[Channel, ...] = ()
    edges: tuple[Edge, ...] = ()
    is_grouped: bool = False  # each namespace gets a frame

    def vertices(self) -> list[Member | Channel]:
        """Return all members and channels, members first."""
        return [*self.members, *self.channels]

    def ids(self) -> list[str]:
        """Return all ids, members first."""
        return [vertex.id for vertex in self.vertices()]

    def arrows(self) -> list[tuple[str, str]]:
        """Return the ids at both ends of each edge."""
        return [(edge.source, edge.target) for edge in self.edges]

    def groups(self) -> dict[str, list[str]]:
        """Return the ids in each framed namespace, sorted; last, under "", those in none."""
        found: dict[str, list[str]] = {}
        for vertex in self.vertices():
            found.setdefault(vertex.group if self.is_grouped else "", []).append(vertex.id)
        return dict(sorted(found.items(), key=lambda item: (not item[0], item[0])))


def outermost(name: str) -> str:
    """Return the first namespace of a name ("/husky0" of "/husky0/odometry"); "" for none."""
    first, slash, _ = name[1:].partition("/")
    return f"/{first}" if name.startswith("/") and slash and first else ""
