"""A diagram as plain values for JSON, whose keys are stable.

``cycles`` are ids in the order of data flow. Ids are valid within one document only. The value of a
key is null if unknown.
"""

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member
from lcmtools.graph.drawing.order import cycles


def write(diagram: Diagram) -> dict[str, object]:
    """Return the document of a diagram; its lists may be empty."""
    return {
        "nodes": [_member(member) for member in diagram.members],
        "topics": [_channel(c, "topic") for c in diagram.channels if not c.is_service],
        "services": [_channel(c, "service") for c in diagram.channels if c.is_service],
        "edges": [_edge(edge) for edge in diagram.edges],
        "cycles": cycles(diagram.ids(), diagram.arrows()),
    }


def _member(member: Member) -> dict[str, object]:
    return {
        "id": member.id,
        "node": member.name if member.is_node else None,
        "observed": not member.is_node,
        "host": member.host or None,
        "pid": member.pid,
        "command": member.command or None,
        "user": member.user or None,
        "stale": member.stale or None,
        "tool": member.is_tool,
        "listens": member.listens,
    }


def _channel(channel: Channel, kind: str) -> dict[str, object]:
    return {
        "id": channel.id,
        kind: channel.name,
        "types": list(channel.types),
        **({} if channel.is_service else {"messages": channel.messages, "rate": channel.rate}),
    }


def _edge(edge: Edge) -> dict[str, object]:
    return {
        "from": edge.source,
        "to": edge.target,
        "kind": edge.relation.value,
        "messages": edge.messages,
        "rate": edge.rate,
        "topics": list(edge.topics),
    }
