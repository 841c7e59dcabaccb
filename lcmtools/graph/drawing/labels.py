"""The texts of a diagram: names, notes, labels and tips; the same in every format."""

import re

from lcmtools.graph.command_line import shortened
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member

_UNSHOWN = re.compile("[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
"""Controls, line ends, changes of direction, surrogates, and other characters not in XML 1.0."""
_LONGEST_COMMAND = 40  # characters
_MOST_TOPICS = 4  # topics beside an arrow


def title(member: Member) -> str:
    """Return a member's name: a node's own, or a program's with its arguments."""
    if member.is_node:
        return member.name
    return shortened(member.name, _LONGEST_COMMAND) or "a program"


def notes(member: Member) -> list[str]:
    """Return short texts on a member, in addition to its name."""
    texts = []
    if not member.is_node:
        texts.append("no node" if member.pid is None else f"no node, pid {member.pid}")
    if not member.is_here:
        texts.append(f"on {member.host or 'another computer'}")
    if member.looks_on:
        texts.append("observes")
    if member.listens:
        texts.append("receives unknown channels")
    if member.stale:
        texts.append(f"stale: {member.stale}")
    return texts


def names(diagram: Diagram) -> dict[str, str]:
    """Return the name of each vertex by its id; members with the same name get their pids."""
    titles = [title(member) for member in diagram.members]
    found = {channel.id: channel.name for channel in diagram.channels}
    for member, name in zip(diagram.members, titles, strict=True):
        is_unique = titles.count(name) == 1 or member.pid is None
        found[member.id] = name if is_unique else f"{name} (pid {member.pid})"
    return found


def counted(diagram: Diagram) -> str:
    """Return the numbers of nodes, programs, topics and services as text."""
    services = sum(channel.is_service for channel in diagram.channels)
    counts = {
        "node": sum(member.is_node for member in diagram.members),
        "other program": sum(not member.is_node for member in diagram.members),
        "topic": len(diagram.channels) - services,
        "service": services,
    }
    texts = [f"{n} {noun}{'' if n == 1 else 's'}" for noun, n in counts.items() if n]
    return ", ".join(texts) or "nothing"


def rate_text(rate: float | None) -> str:
    """Return a rate as text; "" if it was not measured."""
    return "" if rate is None else f"{rate:.1f} Hz"


def vertex_labels(diagram: Diagram) -> dict[str, list[str]]:
    """Return the lines in each vertex, the name first."""
    known = names(diagram)
    lines = {m.id: [known[m.id], *_short_notes(m)] for m in diagram.members}
    for c in diagram.channels:
        lines[c.id] = [c.name, *(c.type_texts or ([] if c.is_service else [c.type_text]))]
    return {id_: [printable(line) for line in rows] for id_, rows in lines.items()}


def edge_label(edge: Edge) -> list[str]:
    """Return the lines beside an arrow: its rate, or the topics that it replaces."""
    rows = [rate_text(edge.rate)] if edge.rate is not None else []
    rows += [printable(topic) for topic in edge.topics]
    if len(rows) > _MOST_TOPICS:
        return [*rows[: _MOST_TOPICS - 1], f"and {len(rows) - _MOST_TOPICS + 1} more"]
    return rows


def vertex_tips(diagram: Diagram) -> dict[str, list[str]]:
    """Return the lines that pop up over each vertex."""
    lines = {member.id: _member_tip(member) for member in diagram.members}
    lines.update({c.id: _channel_tip(c) for c in diagram.channels})
    return {id_: [printable(line) for line in rows] for id_, rows in lines.items()}


def edge_tip(edge: Edge) -> list[str]:
    """Return the lines that pop up over an arrow."""
    counted = f", {edge.messages} messages" if edge.messages else ""
    rate = f", {rate_text(edge.rate)}" if edge.rate is not None else ""
    return [f"{edge.relation.value}{counted}{rate}", *map(printable, edge.topics)]


def printable(text: str) -> str:
    """Return a text with all characters escaped that cannot be shown or are not in XML.

    A channel's name may have any bytes; those that are not UTF-8 come as surrogates.
    """
    if text.isprintable():  # the usual case
        return text
    return _UNSHOWN.sub(_escaped, text)


def _short_notes(member: Member) -> list[str]:
    # a stale node's long reason is in its tip
    return ["(stale)" if note.startswith("stale") else f"({note})" for note in notes(member)]


def _member_tip(member: Member) -> list[str]:
    about = {"host": member.host, "pid": member.pid, "command": member.command, "user": member.user}
    rows = [f"{key}: {value}" for key, value in about.items() if value not in ("", None)]
    return [member.name or "a program", *notes(member), *rows]


def _channel_tip(channel: Channel) -> list[str]:
    rows = [channel.name, f"type: {channel.type_text}"]
    if channel.is_service:
        return [*rows, "a service"]
    rows.append(f"messages: {channel.messages}")
    return rows + ([rate_text(channel.rate)] if channel.rate is not None else [])


def _escaped(match: re.Match[str]) -> str:
    code = ord(match[0])
    if 0xDC80 <= code <= 0xDCFF:  # noqa: PLR2004 - a byte that is not UTF-8
        code -= 0xDC00
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"  # noqa: PLR2004
