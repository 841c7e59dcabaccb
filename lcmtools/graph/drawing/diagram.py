"""What a picture is made of: members of the bus, the channels between them, and who uses which.

Plain values and their words. Must not know how a picture is written.
"""

from dataclasses import dataclass, field
from enum import Enum

from lcmtools.names import is_hidden

QUIET = frozenset({"/clock", "/rosout", "/rosout_agg", "/statistics", "/parameter_events"})
"""Topics that nearly every node has: they would connect everything with everything."""

_MOST_OF_COMMAND = 40  # characters in a picture


class Flow(Enum):
    """What a member does with a channel, or, where channels are not drawn, with another member."""

    PUBLISHES = "publishes"
    SUBSCRIBES = "subscribes"
    CALLS = "calls"
    SERVES = "serves"
    FEEDS = "feeds"


@dataclass(frozen=True, slots=True)
class Member:
    """A node, or a program that is none.

    Attributes:
        id: Unique in its diagram, letters and digits: "n1".
        name: A node's full name, a program's command line; "" for a program of which that is not
            known.
        host: Its computer: a name, or an address where that alone is known; "" for unknown.
        is_here: Whether that is this computer.
        pid: Its process; None where that is not known.
        command: Its command line; "" where that is not known.
        user: Whose it is; "" where that is not known.
        is_node: False for a program that was only seen from outside.
        is_tool: A command of lcmtools, as echo or pub, which is a node for a while.
        publishes: It sends messages; a command that does is more than an onlooker.
        listens: A program that receives from the bus, on channels that LCM does not tell.
        stale: Why a node counts as stale; "" for one that is alive.
    """

    id: str
    name: str
    host: str = ""
    is_here: bool = True
    pid: int | None = None
    command: str = ""
    user: str = ""
    is_node: bool = True
    is_tool: bool = False
    publishes: bool = False
    listens: bool = False
    stale: str = ""

    @property
    def looks_on(self) -> bool:
        """Whether it is a command that changes nothing for anybody."""
        return self.is_tool and not self.publishes

    @property
    def is_hidden(self) -> bool:
        """Whether it is left out for its name; commands have hidden names, but pub takes part."""
        return self.is_node and is_hidden(self.name) and not (self.is_tool and self.publishes)

    @property
    def group(self) -> str:
        """The outermost namespace that it stands in; "" for none."""
        return outermost(self.name) if self.is_node else ""


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic, or a service.

    Attributes:
        id: Unique in its diagram, letters and digits: "t1", or "s1" for a service.
        name: Its full name.
        types: As announced, else as seen; () where no type is known.
        is_service: Whether it is a service.
        messages: How many were announced as sent, or seen; 0 for a service.
        rate: How often they come [Hz]; None where that was not measured.
    """

    id: str
    name: str
    types: tuple[str, ...] = ()
    is_service: bool = False
    messages: int = 0
    rate: float | None = None

    @property
    def is_hidden(self) -> bool:
        """Whether lists leave it out."""
        return is_hidden(self.name)

    @property
    def is_quiet(self) -> bool:
        """Whether it is one of those that nearly every node has."""
        return not self.is_service and self.name in QUIET

    @property
    def group(self) -> str:
        """The outermost namespace that it stands in; "" for none."""
        return outermost(self.name)

    @property
    def type_text(self) -> str:
        """Its types, for people."""
        return ", ".join(self.types) or "unknown type"


@dataclass(frozen=True, slots=True)
class Edge:
    """Where messages or calls flow.

    Attributes:
        source: The id of where they come from.
        target: The id of where they go.
        flow: What that is.
        messages: How many, as the member counts them, or as seen.
        rate: How often [Hz]; None where that was not measured.
        topics: Where channels are not drawn: the names of those that this stands for.
    """

    source: str
    target: str
    flow: Flow
    messages: int = 0
    rate: float | None = None
    topics: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Diagram:
    """What is drawn.

    Attributes:
        members: Nodes and programs.
        channels: Topics and services; none where members are connected directly.
        edges: Between them.
        is_grouped: Whether what stands in a namespace is framed.
    """

    members: tuple[Member, ...] = ()
    channels: tuple[Channel, ...] = ()
    edges: tuple[Edge, ...] = field(default=())
    is_grouped: bool = False

    def vertices(self) -> list[Member | Channel]:
        """All that is drawn, members first."""
        return [*self.members, *self.channels]

    def groups(self) -> dict[str, list[str]]:
        """The ids in each namespace that is framed, sorted; without what stands in none."""
        if not self.is_grouped:
            return {}
        found: dict[str, list[str]] = {}
        for vertex in self.vertices():
            if vertex.group:
                found.setdefault(vertex.group, []).append(vertex.id)
        return dict(sorted(found.items()))

    def ids(self) -> list[str]:
        """All ids, members first."""
        return [vertex.id for vertex in self.vertices()]

    def names(self) -> dict[str, str]:
        """What each id is called where it stands alone: two of the same name stay two."""
        titles = [title(member) for member in self.members]
        names = {channel.id: channel.name for channel in self.channels}
        for member, name in zip(self.members, titles, strict=True):
            is_alone = titles.count(name) == 1 or member.pid is None
            names[member.id] = name if is_alone else f"{name} (pid {member.pid})"
        return names


def outermost(name: str) -> str:
    """The first namespace of a global name ("/husky0" of "/husky0/odometry"); "" for none."""
    first, slash, _ = name[1:].partition("/")
    return f"/{first}" if name.startswith("/") and slash and first else ""


def title(member: Member) -> str:
    """What a member is called: a node's name, a program's command without its folder."""
    if member.is_node:
        return member.name
    if not member.name.strip():
        return "a program"
    program, *arguments = member.name.split()
    command = " ".join([program.rpartition("/")[2] or program, *arguments])
    is_long = len(command) > _MOST_OF_COMMAND
    return f"{command[: _MOST_OF_COMMAND - 1]}…" if is_long else command


def notes(member: Member) -> list[str]:
    """What is to be said of a member besides its name, in a few words each."""
    said = []
    if not member.is_node:
        said.append("no node" if member.pid is None else f"no node, pid {member.pid}")
    if not member.is_here:
        said.append(f"on {member.host or 'another computer'}")
    if member.looks_on:
        said.append("looks on")
    if member.listens:
        said.append("listens to channels unknown")
    if member.stale:
        said.append(f"stale: {member.stale}")
    return said


def rate_text(rate: float | None) -> str:
    """A rate as it is shown; "" where it was not measured."""
    return "" if rate is None else f"{rate:.1f} Hz"


def printable(text: str) -> str:
    """A text whose every character can be shown and stand in XML: others are escaped.

    A channel's name may be any bytes: what is not UTF-8 comes as surrogates.
    """
    return "".join(c if _is_plain(c) else _escaped(c) for c in text)


def _is_plain(character: str) -> bool:
    """Not a control character, nor one that turns the direction of what follows, nor no character.

    The last are those that XML 1.0 does not have.
    """
    code = ord(character)
    return not (
        code < 0x20  # noqa: PLR2004
        or 0x7F <= code < 0xA0  # noqa: PLR2004
        or 0x2028 <= code <= 0x202E  # noqa: PLR2004 - lines' ends, and directions
        or 0x2066 <= code <= 0x2069  # noqa: PLR2004 - directions
        or 0xD800 <= code < 0xE000  # noqa: PLR2004 - surrogates
        or code & 0xFFFE == 0xFFFE  # noqa: PLR2004 - U+FFFF and its like
    )


def _escaped(character: str) -> str:
    code = ord(character)
    if 0xDC80 <= code <= 0xDCFF:  # noqa: PLR2004 - a byte that is no UTF-8
        code -= 0xDC00
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"  # noqa: PLR2004
