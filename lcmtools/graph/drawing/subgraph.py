"""Selecting the part of a diagram that is drawn. Functions from diagrams to diagrams."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation
from lcmtools.graph.drawing.labels import title
from lcmtools.names import Pattern, has_wildcard


@dataclass(frozen=True, slots=True)
class DiagramOptions:
    """The selection of a diagram's content: namespaces, names and patterns; () selects all."""

    parts: tuple[str, ...] = ()  # drawn with their direct neighbours
    topics: tuple[str, ...] = ()  # topics and services, drawn with their users
    excluded: tuple[str, ...] = ()  # not drawn
    everything: bool = False  # hidden names, quiet topics, tools and leaf topics too
    leaf_topics: bool = False  # topics with only one side and no message
    tools: bool = False  # observing commands
    services: bool = False


@dataclass(frozen=True, slots=True)
class LeftOut:
    """The content left out: numbers of leaf topics, tools, hidden names; names of quiet topics."""

    leaf_topics: int = 0
    quiet: tuple[str, ...] = ()
    tools: int = 0
    hidden: int = 0

    def text(self) -> str:
        """Return it as one line, with the options that show it; "" if nothing is left out."""
        leaves, tools, hidden = self.leaf_topics, self.tools, self.hidden
        parts = {
            f"{leaves} unused topic{'s' * (leaves > 1)}, without a publisher or without a"
            " subscriber (add --leaf-topics)": leaves,
            f"{', '.join(self.quiet)}, which nearly all nodes use (add --all)": self.quiet,
            f"{tools} command{'s' * (tools > 1)} that observe{'s' * (tools == 1)} the bus"
            " (add --tools)": tools,
            f"{hidden} name{'s' * (hidden > 1)} with a part that begins with _ (add --all)": hidden,
        }
        listed = "; ".join(text for text, count in parts.items() if count)
        return f"not drawn: {listed}" if listed else ""


def select(diagram: Diagram, wanted: DiagramOptions) -> tuple[Diagram, LeftOut]:
    """Return the selected part of a diagram, and the content left out."""
    named = _named(diagram, wanted)
    members = [m for m in named.members if _is_drawn(m, wanted)]
    channels = [c for c in named.channels if _is_shown(c, wanted)]
    used = drawn = _with(named, members, channels)
    if not (wanted.everything or wanted.leaf_topics):
        drawn = _with(used, members, _active(used, wanted))
    there = {m.id for m in members} | {c.id for c in channels}
    gone = [vertex for vertex in named.vertices() if vertex.id not in there]
    left = LeftOut(
        leaf_topics=len(used.channels) - len(drawn.channels),
        quiet=tuple(v.name for v in gone if isinstance(v, Channel) and v.is_quiet),
        tools=sum(isinstance(v, Member) and v.looks_on for v in gone),
        hidden=sum(v.is_hidden and not (isinstance(v, Member) and v.looks_on) for v in gone),
    )
    return drawn, left


def members_only(diagram: Diagram) -> Diagram:
    """Return a diagram without channels: publishers are connected to subscribers."""
    names = {channel.id: channel.name for channel in diagram.channels}
    into: dict[str, list[Edge]] = {}
    out: dict[str, list[Edge]] = {}
    for edge in diagram.edges:
        if edge.target in names:
            into.setdefault(edge.target, []).append(edge)
        else:
            out.setdefault(edge.source, []).append(edge)
    found: dict[tuple[str, str, bool], list[str]] = {}
    for channel in diagram.channels:
        for source in into.get(channel.id, []):
            for target in out.get(channel.id, []):
                key = (source.source, target.target, channel.is_service)
                found.setdefault(key, []).append(channel.name)
    edges = [
        Edge(source, target, Relation.CALLS if is_service else Relation.FEEDS, topics=tuple(topics))
        for (source, target, is_service), topics in found.items()
    ]
    return replace(diagram, channels=(), edges=tuple(edges))


def is_meant(name: str, wanted: str, *, is_topic: bool = False) -> bool:
    """Return whether a word selects a name: it is the name, its last part, a namespace or pattern.

    A pattern with one part also matches a node's last part, but not a topic's.
    """
    pattern = _pattern(wanted)
    return pattern.covers(name) if is_topic and has_wildcard(wanted) else pattern.means_node(name)


def _is_topic(name: str, words: Iterable[str]) -> bool:
    return any(is_meant(name, word, is_topic=True) for word in words)


@cache
def _pattern(word: str) -> Pattern:
    return Pattern(word, hidden=True)


def _named(diagram: Diagram, wanted: DiagramOptions) -> Diagram:
    members = [m for m in diagram.members if not _is_any(m, wanted.excluded)]
    channels = [c for c in diagram.channels if not _is_topic(c.name, wanted.excluded)]
    channels = [c for c in channels if wanted.services or not c.is_service]
    if wanted.topics:
        channels = [c for c in channels if _is_topic(c.name, wanted.topics)]
    there = _with(diagram, members, channels)
    if wanted.topics:
        using = {end for edge in there.edges for end in (edge.source, edge.target)}
        there = replace(there, members=tuple(m for m in members if m.id in using))
    return _around(there, wanted.parts) if wanted.parts else there


def _around(diagram: Diagram, parts: Sequence[str]) -> Diagram:
    # the neighbours of a member are those on the other side of its channels
    near = {m.id for m in diagram.members if _is_any(m, parts)}
    near |= {c.id for c in diagram.channels if _is_topic(c.name, parts)}
    channels = {channel.id for channel in diagram.channels}
    kept = {edge for edge in diagram.edges if edge.source in near or edge.target in near}
    fed = {edge.target for edge in kept} & channels  # channels on which a selected member publishes
    feeding = {edge.source for edge in kept} & channels
    edges = [e for e in diagram.edges if e in kept or e.source in fed or e.target in feeding]
    there = near | {edge.source for edge in edges} | {edge.target for edge in edges}
    members = tuple(m for m in diagram.members if m.id in there)
    shown = tuple(c for c in diagram.channels if c.id in there)
    return replace(diagram, members=members, channels=shown, edges=tuple(edges))


def _is_any(member: Member, words: Iterable[str]) -> bool:
    """Return whether a member is selected; a program by its pid, command or a word of that."""
    if member.is_node:
        return any(is_meant(member.name, word) for word in words)
    names = [title(member), str(member.pid), *(w.rpartition("/")[2] for w in member.name.split())]
    return any(_pattern(word).matches(name) for name in names for word in words)


def _is_drawn(member: Member, wanted: DiagramOptions) -> bool:
    if member.looks_on:
        return wanted.tools or wanted.everything
    return wanted.everything or not member.is_hidden or member.name in wanted.parts


def _is_shown(channel: Channel, wanted: DiagramOptions) -> bool:
    is_usual = not channel.is_quiet and not channel.is_hidden
    return is_usual or wanted.everything or _is_named(channel, wanted)


def _is_named(channel: Channel, wanted: DiagramOptions) -> bool:
    return channel.name in wanted.topics or channel.name in wanted.parts


def _active(diagram: Diagram, wanted: DiagramOptions) -> list[Channel]:
    # topics that carry messages or have both sides, and all services
    both = {edge.target for edge in diagram.edges} & {edge.source for edge in diagram.edges}
    return [
        c
        for c in diagram.channels
        if c.is_service or c.messages or c.id in both or _is_named(c, wanted)
    ]


def _with(diagram: Diagram, members: Sequence[Member], channels: Sequence[Channel]) -> Diagram:
    # only the channels that these members use
    there = {member.id for member in members} | {channel.id for channel in channels}
    edges = tuple(e for e in diagram.edges if e.source in there and e.target in there)
    used = Counter(end for edge in edges for end in (edge.source, edge.target))
    drawn = tuple(channel for channel in channels if used[channel.id])
    return replace(diagram, members=tuple(members), channels=drawn, edges=edges)
