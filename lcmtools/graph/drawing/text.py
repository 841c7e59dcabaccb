"""A diagram as a tree of lines for a terminal: who publishes, what, and who hears it.

Members stand in the order in which data flow; one that only hears stands where it hears. Names go
as they are, but for characters that no terminal should get.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from lcmtools.graph.drawing.diagram import (
    Channel,
    Diagram,
    Edge,
    Member,
    notes,
    printable,
    rate_text,
)
from lcmtools.graph.drawing.order import cycles, reading_order

NO_PUBLISHER = "(nobody publishes)"
NO_CLIENT = "(no client announced)"


@dataclass(frozen=True, slots=True)
class Signs:
    """What lines are drawn with.

    Attributes:
        branch: Before one that others follow.
        last: Before the last one.
        bar: Beside what stands below one that others follow.
        gap: Beside what stands below the last one.
        line: Between a member and what it publishes.
        arrow: Before whoever hears it.
        to: Between two names in one line.
        cut: In place of what is left out of a long name.
    """

    branch: str = "├"
    last: str = "└"
    bar: str = "│  "
    gap: str = "   "
    line: str = "─ "
    arrow: str = "→ "
    to: str = " → "
    cut: str = "…"


UNICODE = Signs()
ASCII = Signs("|", "`", "|  ", "   ", "- ", "> ", " -> ", "...")


def write(diagram: Diagram, signs: Signs = UNICODE, width: int | None = None) -> list[str]:
    """The lines of a diagram; none for an empty one.

    Args:
        diagram: What is drawn.
        signs: What the lines are drawn with.
        width: Columns there are; types are left out where they do not fit. None for any number.
    """
    tree = _Tree(diagram, signs, width)
    rows = [row for block in tree.blocks() for row in block]
    found = tree.cycles()
    return [*rows, *([""] if found else []), *found]


class _Tree:
    """A diagram by what comes out of each of its vertices."""

    def __init__(self, diagram: Diagram, signs: Signs, width: int | None) -> None:
        self._diagram = diagram
        self._signs = signs
        self._width = width
        self._members = {member.id: member for member in diagram.members}
        self._channels = {channel.id: channel for channel in diagram.channels}
        self._names = {id_: self._shown(name) for id_, name in diagram.names().items()}
        self._arrows = [(edge.source, edge.target) for edge in diagram.edges]
        self._out: dict[str, list[Edge]] = {vertex: [] for vertex in diagram.ids()}
        for edge in sorted(diagram.edges, key=lambda edge: self._names[edge.target]):
            self._out[edge.source].append(edge)

    def blocks(self) -> Iterator[list[str]]:
        """The lines of each member that publishes anything, or is connected to nothing."""
        fed = {target for _, target in self._arrows}
        for vertex in reading_order(self._diagram.ids(), self._arrows):
            if vertex in self._members and (self._out[vertex] or vertex not in fed):
                yield [self._member(self._members[vertex]), *self._branches(self._out[vertex])]
        unfed = [channel for channel in self._diagram.channels if channel.id not in fed]
        for is_service, heading in ((False, NO_PUBLISHER), (True, NO_CLIENT)):
            if some := [channel for channel in unfed if channel.is_service is is_service]:
                yield [heading, *self._channels_of((channel, None) for channel in some)]

    def cycles(self) -> list[str]:
        """A line for each way that leads back to where it began."""
        ways = cycles(self._diagram.ids(), self._arrows)
        return [
            f"cycle: {self._signs.to.join(self._names[v] for v in (*way, way[0]))}" for way in ways
        ]

    def _branches(self, edges: list[Edge]) -> list[str]:
        direct = [edge for edge in edges if edge.target in self._members]
        if direct:
            return self._hearers(direct)
        return self._channels_of((self._channels[edge.target], edge.rate) for edge in edges)

    def _channels_of(self, published: Iterable[tuple[Channel, float | None]]) -> list[str]:
        rows = []
        known = list(published)
        for number, (channel, rate) in enumerate(known, 1):
            start, side = self._start(number == len(known))
            rows.append(self._channel(f"{start}{self._signs.line}", channel, rate))
            rows += [f"{side}{row}" for row in self._hearers(self._out[channel.id])]
        return rows

    def _hearers(self, edges: list[Edge]) -> list[str]:
        rows = []
        for number, edge in enumerate(edges, 1):
            start, _ = self._start(number == len(edges))
            topics = f": {', '.join(map(self._shown, edge.topics))}" if edge.topics else ""
            hearer = self._member(self._members[edge.target])
            rows.append(f"{start}{self._signs.arrow}{hearer}{topics}")
        return rows

    def _start(self, is_last: bool) -> tuple[str, str]:  # noqa: FBT001 - private
        """What stands before a row, and beside the rows below it."""
        signs = self._signs
        return (signs.last, signs.gap) if is_last else (signs.branch, signs.bar)

    def _channel(self, start: str, channel: Channel, rate: float | None) -> str:
        often = rate_text(channel.rate if rate is None else rate)
        behind = f"{f' {often}' if often else ''}{' (service)' if channel.is_service else ''}"
        row = f"{start}{self._names[channel.id]}{behind}"
        whole = f"{start}{self._names[channel.id]} [{self._shown(channel.type_text)}]{behind}"
        return whole if self._width is None or len(whole) <= self._width else row

    def _member(self, member: Member) -> str:
        name, known = self._names[member.id], self._notes(member)
        return f"{name} ({known})" if known else name

    def _notes(self, member: Member) -> str:
        return self._shown(", ".join(notes(member)))

    def _shown(self, text: str) -> str:
        return printable(text).replace("…", self._signs.cut)


def signs_for(encoding: str | None, environment: Mapping[str, str]) -> Signs:
    """What lines can be drawn with where a text goes.

    Args:
        encoding: That of the stream; None for unknown.
        environment: The environment variables: the C locale knows ASCII alone.
    """
    names = (environment.get(name) for name in ("LC_ALL", "LC_CTYPE", "LANG"))
    locale = next((name for name in names if name), "C")
    try:
        "├└│─→…".encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return ASCII
    return ASCII if locale in ("C", "POSIX") else UNICODE
