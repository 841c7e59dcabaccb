"""A diagram as a tree of lines for a terminal: publisher, topic, subscriber.

Members are in the order of data flow; one that only subscribes is below its topics. Names are
unchanged, except for characters that must not be sent to a terminal.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member
from lcmtools.graph.drawing.labels import names, notes, printable, rate_text
from lcmtools.graph.drawing.order import cycles, reading_order

NO_PUBLISHER = "(no publisher)"
NO_CLIENT = "(no client announced)"
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Signs:
    """The characters with which lines are drawn."""

    branch: str = "├"
    last: str = "└"  # the last branch
    bar: str = "│  "  # beside the rows below a branch
    gap: str = "   "  # beside the rows below the last one
    line: str = "─ "  # between a member and its topic
    arrow: str = "→ "  # before a subscriber
    to: str = " → "  # between two names in one line
    cut: str = "…"  # for the rest of a long name


UNICODE = Signs()
ASCII = Signs("|", "`", "|  ", "   ", "- ", "> ", " -> ", "...")


def write(diagram: Diagram, signs: Signs = UNICODE, width: int | None = None) -> list[str]:
    """Return the lines of a diagram; types that do not fit into ``width`` columns are left out."""
    tree = _Tree(diagram, signs, width)
    rows = [row for block in tree.blocks() for row in block]
    found = tree.cycles()
    return [*rows, *([""] if found else []), *found]


class _Tree:
    def __init__(self, diagram: Diagram, signs: Signs, width: int | None) -> None:
        self._diagram = diagram
        self._signs = signs
        self._width = width
        self._members = {member.id: member for member in diagram.members}
        self._channels = {channel.id: channel for channel in diagram.channels}
        self._names = {id_: self._shown(name) for id_, name in names(diagram).items()}
        self._out: dict[str, list[Edge]] = {vertex: [] for vertex in diagram.ids()}
        for edge in sorted(diagram.edges, key=lambda edge: self._names[edge.target]):
            self._out[edge.source].append(edge)

    def blocks(self) -> Iterator[list[str]]:
        """Yield the lines of each member that publishes, or is unconnected."""
        fed = {edge.target for edge in self._diagram.edges}
        for vertex in reading_order(self._diagram.ids(), self._diagram.arrows()):
            if vertex in self._members and (self._out[vertex] or vertex not in fed):
                yield [self._member(self._members[vertex]), *self._branches(self._out[vertex])]
        unfed = [channel for channel in self._diagram.channels if channel.id not in fed]
        for is_service, heading in ((False, NO_PUBLISHER), (True, NO_CLIENT)):
            if some := [channel for channel in unfed if channel.is_service is is_service]:
                yield [heading, *self._channel_rows((channel, None) for channel in some)]

    def cycles(self) -> list[str]:
        found = cycles(self._diagram.ids(), self._diagram.arrows())
        return [f"cycle: {self._signs.to.join(self._names[v] for v in (*c, c[0]))}" for c in found]

    def _branches(self, edges: list[Edge]) -> list[str]:
        direct = [edge for edge in edges if edge.target in self._members]
        if direct:
            return self._member_rows(direct)
        return self._channel_rows((self._channels[edge.target], edge.rate) for edge in edges)

    def _channel_rows(self, published: Iterable[tuple[Channel, float | None]]) -> list[str]:
        rows = []
        for start, side, (channel, rate) in self._branched(published):
            rows.append(self._channel(f"{start}{self._signs.line}", channel, rate))
            rows += [f"{side}{row}" for row in self._member_rows(self._out[channel.id])]
        return rows

    def _member_rows(self, edges: list[Edge]) -> list[str]:
        rows = []
        for start, _, edge in self._branched(edges):
            topics = f": {', '.join(map(self._shown, edge.topics))}" if edge.topics else ""
            member = self._member(self._members[edge.target])
            rows.append(f"{start}{self._signs.arrow}{member}{topics}")
        return rows

    def _branched(self, items: Iterable[_T]) -> Iterator[tuple[str, str, _T]]:
        """Yield the prefix of each item's row, that of the rows below it, and the item."""
        signs, known = self._signs, list(items)
        for item in known[:-1]:
            yield signs.branch, signs.bar, item
        for item in known[-1:]:
            yield signs.last, signs.gap, item

    def _channel(self, start: str, channel: Channel, rate: float | None) -> str:
        rate_shown = rate_text(channel.rate if rate is None else rate)
        behind = f"{f' {rate_shown}' if rate_shown else ''}{' (service)' * channel.is_service}"
        row = f"{start}{self._names[channel.id]}{behind}"
        whole = f"{start}{self._names[channel.id]} [{self._shown(channel.type_text)}]{behind}"
        return whole if self._width is None or len(whole) <= self._width else row

    def _member(self, member: Member) -> str:
        text = self._shown(", ".join(notes(member)))
        return f"{self._names[member.id]} ({text})" if text else self._names[member.id]

    def _shown(self, text: str) -> str:
        return printable(text).replace("…", self._signs.cut)


def signs_for(encoding: str | None, environment: Mapping[str, str]) -> Signs:
    """Return the characters that can be shown: ASCII if the encoding or the C locale needs it."""
    variables = (environment.get(name) for name in ("LC_ALL", "LC_CTYPE", "LANG"))
    locale = next((value for value in variables if value), "C")
    try:
        "├└│─→…".encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return ASCII
    return ASCII if locale in ("C", "POSIX") else UNICODE
