"""What is written into a picture's vertices and beside its arrows; the same in all formats."""

from lcmtools.graph.drawing.diagram import (
    Channel,
    Diagram,
    Edge,
    Member,
    notes,
    printable,
    rate_text,
)

_MOST_TOPICS = 4  # beside an arrow


def vertex_labels(diagram: Diagram) -> dict[str, list[str]]:
    """The lines in each vertex, the name first."""
    names = diagram.names()
    lines = {m.id: [names[m.id], *_notes(m)] for m in diagram.members}
    lines.update({c.id: [c.name, *_about(c)] for c in diagram.channels})
    return {id_: [printable(line) for line in rows] for id_, rows in lines.items()}


def edge_label(edge: Edge) -> list[str]:
    """The lines beside an arrow: how often messages come, or which topics it stands for."""
    rows = [rate_text(edge.rate)] if edge.rate is not None else []
    rows += [printable(topic) for topic in edge.topics]
    if len(rows) > _MOST_TOPICS:
        return [*rows[: _MOST_TOPICS - 1], f"and {len(rows) - _MOST_TOPICS + 1} more"]
    return rows


def vertex_tips(diagram: Diagram) -> dict[str, list[str]]:
    """What more there is to know of each vertex, for those who point at it."""
    lines = {member.id: _tip(member) for member in diagram.members}
    lines.update({c.id: _channel_tip(c) for c in diagram.channels})
    return {id_: [printable(line) for line in rows] for id_, rows in lines.items()}


def edge_tip(edge: Edge) -> list[str]:
    """What more there is to know of an arrow."""
    counted = f", {edge.messages} messages" if edge.messages else ""
    often = f", {rate_text(edge.rate)}" if edge.rate is not None else ""
    return [f"{edge.flow.value}{counted}{often}", *map(printable, edge.topics)]


def _notes(member: Member) -> list[str]:
    """A stale node's reason is long: its tip has it."""
    return ["(stale)" if note.startswith("stale") else f"({note})" for note in notes(member)]


def _about(channel: Channel) -> list[str]:
    return [*channel.types] or ([] if channel.is_service else [channel.type_text])


def _tip(member: Member) -> list[str]:
    rows = [member.name or "a program", *notes(member)]
    if member.host:
        rows.append(f"host: {member.host}")
    if member.pid is not None:
        rows.append(f"pid: {member.pid}")
    if member.command:
        rows.append(f"command: {member.command}")
    return rows + ([f"user: {member.user}"] if member.user else [])


def _channel_tip(channel: Channel) -> list[str]:
    rows = [channel.name, f"type: {channel.type_text}"]
    if channel.is_service:
        return [*rows, "a service"]
    rows.append(f"messages: {channel.messages}")
    return rows + ([rate_text(channel.rate)] if channel.rate is not None else [])
