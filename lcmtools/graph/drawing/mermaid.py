"""A diagram in Mermaid's language (https://mermaid.js.org/syntax/flowchart.html).

Ids are the diagram's; names are in quotes, with all characters that have a meaning in the language,
in HTML or in Markdown written as entities: "#", the character's number and ";".
"""

import re
from collections.abc import Iterable

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation
from lcmtools.graph.drawing.labels import edge_label, printable, vertex_labels

_STYLES = """\
  classDef node fill:#e3f2fd,stroke:#1565c0,color:#111
  classDef topic fill:#fafafa,stroke:#455a64,color:#111
  classDef service fill:#f1f8e9,stroke:#558b2f,color:#111
  classDef program fill:#fff,stroke:#616161,color:#111,stroke-dasharray:4 3
  classDef stale fill:#fff,stroke:#c62828,color:#c62828,stroke-dasharray:4 3"""
_OWN = re.compile(r"[^\w /.,:()=-]|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])|^[-=]|^\d(?=\d*[.)]\s)")
"""Characters that need escaping, including those that start emphasis or a list in Markdown."""


def write(diagram: Diagram) -> str:
    """Return the document of a diagram, ended by a newline."""
    labels = vertex_labels(diagram)
    rows = {m.id: f"{m.id}([{_text(labels[m.id])}]):::{_kind(m)}" for m in diagram.members}
    rows.update({c.id: _channel(c, _text(labels[c.id])) for c in diagram.channels})
    lines = ["flowchart LR"]
    for number, (group, ids) in enumerate(diagram.groups().items(), 1):
        own = [f"  {rows[id_]}" for id_ in ids]
        frame = [f"  subgraph g{number}[{_text([printable(group)])}]"]
        lines += [*frame, *(f"  {row}" for row in own), "  end"] if group else own
    lines += [f"  {_edge(edge)}" for edge in diagram.edges]
    return "\n".join([*lines, _STYLES, ""])


def fenced(document: str) -> str:
    """Return a document as a Markdown block, which GitHub and others draw."""
    return f"```mermaid\n{document}```\n"


def _kind(member: Member) -> str:
    if member.stale:
        return "stale"
    return "node" if member.is_node else "program"


def _channel(channel: Channel, text: str) -> str:
    if channel.is_service:
        return f"{channel.id}{{{{{text}}}}}:::service"
    return f"{channel.id}[{text}]:::topic"


def _edge(edge: Edge) -> str:
    arrow = "-.->" if edge.relation in (Relation.CALLS, Relation.SERVES) else "-->"
    label = edge_label(edge)
    return f"{edge.source} {arrow}{f'|{_text(label)}|' if label else ''} {edge.target}"


def _text(lines: Iterable[str]) -> str:
    return f'"{"<br/>".join(_OWN.sub(_entity, line) for line in lines)}"'


def _entity(match: re.Match[str]) -> str:
    return "".join(f"#{ord(character)};" for character in match[0])
