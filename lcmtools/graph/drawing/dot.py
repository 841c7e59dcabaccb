"""A diagram in Graphviz's language (https://graphviz.org/doc/info/lang.html).

Names are in quotes: a quote and a backslash get a backslash, and "&" becomes an entity, since
Graphviz reads entities wherever it writes text.
"""

from collections.abc import Iterable

from lcmtools.graph.drawing import labels
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation

_HEAD = """\
digraph lcmtools {
  rankdir=LR;
  bgcolor="white";
  node [fontname="Helvetica", fontsize=11];
  edge [fontname="Helvetica", fontsize=9];"""
_STALE = "#c62828"
_FOREIGN = "#616161"


def write(diagram: Diagram) -> str:
    """Return the document of a diagram, ended by a newline."""
    texts, tips = labels.vertex_labels(diagram), labels.vertex_tips(diagram)
    styles = {member.id: _member(member) for member in diagram.members}
    styles.update({channel.id: _channel(channel) for channel in diagram.channels})
    rows = {
        id_: f"{id_} [label={_text(texts[id_])}, tooltip={_text(tips[id_])}, {style}];"
        for id_, style in styles.items()
    }
    lines = [_HEAD]
    for number, (group, ids) in enumerate(diagram.groups().items(), 1):
        own = [f"  {rows[id_]}" for id_ in ids]
        lines += _cluster(number, group, own) if group else own
    lines += [f"  {_edge(edge)}" for edge in diagram.edges]
    return "\n".join([*lines, "}", ""])


def _cluster(number: int, group: str, rows: Iterable[str]) -> list[str]:
    label = _text([labels.printable(group)])
    frame = f'    label={label}; style="rounded"; color="#9e9e9e"; fontname="Helvetica";'
    return [f"  subgraph cluster_{number} {{", frame, *(f"  {row}" for row in rows), "  }"]


def _member(member: Member) -> str:
    if member.stale:
        return f'shape=ellipse, style=dashed, color="{_STALE}", fontcolor="{_STALE}"'
    if not member.is_node:
        return f'shape=ellipse, style=dashed, color="{_FOREIGN}"'
    return 'shape=ellipse, style=filled, fillcolor="#e3f2fd", color="#1565c0"'


def _channel(channel: Channel) -> str:
    if channel.is_service:
        return 'shape=hexagon, style=filled, fillcolor="#f1f8e9", color="#558b2f"'
    return 'shape=box, style=filled, fillcolor="#fafafa", color="#455a64"'


def _edge(edge: Edge) -> str:
    style = {
        "label": _text(labels.edge_label(edge)),
        "tooltip": _text(labels.edge_tip(edge)),
        "style": "dashed" if edge.relation in (Relation.CALLS, Relation.SERVES) else "",
    }
    words = [f"{name}={value}" for name, value in style.items() if value not in ("", '""')]
    return f"{edge.source} -> {edge.target} [{', '.join(words)}];"


def _text(lines: Iterable[str]) -> str:
    rows = (line.replace("\\", "\\\\").replace('"', '\\"').replace("&", "&amp;") for line in lines)
    return '"' + "\\n".join(rows) + '"'
