"""The stream of the graph: nodes, programs and topics with their positions, and rates on the edges.

It works on its own thread, so that the layout of a large bus delays nothing else.
"""

import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from lcmtools.bus.url import BusUrl, parse_url
from lcmtools.graph.drawing import labels
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member
from lcmtools.graph.drawing.layered import Drawing, Size, layered
from lcmtools.graph.drawing.subgraph import DiagramOptions, members_only, select
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.observe.channels.feed import Snapshot
from lcmtools.observe.reading.senders import Program, programs
from lcmtools.observe.reports.bus_diagram import diagram_of

_LOOK_PERIOD = 0.5  # [s]
_PROGRAMS_PERIOD = 3.0  # [s] between searches of this computer's processes
_LETTER, _LINE, _PADDING = 7.3, 15.0, 26.0  # width of a letter, height of a line, padding [px]


class GraphStream(PageStream):
    """The graph, with the parts that the page wants."""

    period = _LOOK_PERIOD
    is_shared = True

    def __init__(  # noqa: PLR0913 - the parts that a page chooses
        self,
        source: Source,
        *,
        everything: bool = False,
        leaves: bool = True,
        tools: bool = False,
        services: bool = False,
        dead: bool = True,
        topics: bool = True,
        groups: bool = False,
    ) -> None:
        super().__init__(source)
        self._has_dead = dead
        options = DiagramOptions(
            everything=everything, leaf_topics=leaves, tools=tools, services=services
        )
        self._maker = GraphMaker(options, has_topics=topics, has_groups=groups)
        self._url = BusUrl("file", source.name) if source.kind == "log" else parse_url(source.name)
        self._latest: Mapping[str, Json] | None = None
        self._fault = ""
        self._ends_soon = threading.Event()
        self._thread = threading.Thread(target=self._run, name="graph", daemon=True)
        self.until_closed(source.listen_to_all())
        self.until_closed(self._ends_soon.set)
        self._thread.start()

    def update(self) -> Update | None:
        """Return the graph in its latest layout."""
        return None if self._latest is None else Update(self._latest)

    def problem(self) -> str:
        """Return the sentence for an empty graph."""
        if self._fault or self._latest is None or self._latest["vertices"]:
            return self._fault
        return f"there is nothing to draw on the {self.source.kind} yet"

    def _run(self) -> None:
        found: list[Program] = []
        next_look, seen = 0.0, None
        while not self._ends_soon.wait(0.0 if self._latest is None else _LOOK_PERIOD):
            snapshot = self.source.latest
            if snapshot is seen:
                self._ends_soon.wait(_LOOK_PERIOD / 5)
                continue
            seen = snapshot
            try:
                if time.monotonic() >= next_look:
                    next_look = time.monotonic() + _PROGRAMS_PERIOD
                    found = programs(snapshot.graph, self._url)
                self._latest = self._maker.make(self._diagram(snapshot, found))
                self._fault = ""
            except Exception as error:  # noqa: BLE001 - shown in the panel
                self._fault = f"a fault of lcmtools ({type(error).__name__}: {error})"

    def _diagram(self, snapshot: Snapshot, found: Sequence[Program]) -> Diagram:
        rates = {row.channel: row.rate or 0.0 for row in snapshot.rows if row.age is not None}
        graph = snapshot.graph
        if not self._has_dead:
            graph = graph._replace(nodes=tuple(node for node in graph.nodes if not node.stale))
        diagram = diagram_of(graph, found, rates)
        if self.source.kind == "bus":
            return diagram
        # a log's nodes are not on this computer; the labels need not say so
        members = tuple(replace(member, is_here=True) for member in diagram.members)
        return replace(diagram, members=members)


class GraphMaker:
    """Converts diagrams for a page to draw; positions are kept if possible."""

    def __init__(
        self, options: DiagramOptions, *, has_topics: bool = True, has_groups: bool = False
    ) -> None:
        self._options, self._has_topics, self._has_groups = options, has_topics, has_groups
        self._structure: object = None
        self._drawing = Drawing()

    def make(self, whole: Diagram) -> Mapping[str, Json]:
        """Return a diagram with positions, for a page."""
        diagram, left = select(whole, self._options)
        if not self._has_topics:
            diagram = members_only(diagram)
        names = labels.names(diagram)
        keys = {v.id: f"{_kind(v)}:{names[v.id]}" for v in diagram.vertices()}
        texts = {v.id: _texts(v, names[v.id]) for v in diagram.vertices()}
        self._lay_out(diagram, keys, texts)
        tips = labels.vertex_tips(diagram)
        return {
            "size": [round(one) for one in self._drawing.size],
            "groups": self._groups(diagram, keys),
            "vertices": [
                self._vertex(vertex, keys[vertex.id], texts[vertex.id], tips[vertex.id])
                for vertex in diagram.vertices()
            ],
            "edges": [self._edge(edge, keys) for edge in diagram.edges],
            "counted": labels.counted(diagram),
            # without the command line's options
            "leftOut": "; ".join(part.partition(" (add")[0] for part in left.text().split("; ")),
        }

    def _lay_out(
        self, diagram: Diagram, keys: Mapping[str, str], texts: Mapping[str, list[str]]
    ) -> None:
        sizes = {keys[id_]: _size(rows) for id_, rows in texts.items()}
        arrows = list(dict.fromkeys((keys[e.source], keys[e.target]) for e in diagram.edges))
        bands = {keys[v.id]: v.group for v in diagram.vertices()} if self._has_groups else {}
        structure = sorted(sizes.items()), sorted(arrows), sorted(bands.items())
        if structure != self._structure:
            self._structure = structure
            order = dict(sorted(sizes.items()))
            self._drawing = layered(order, sorted(arrows), bands, self._drawing.places)

    def _groups(self, diagram: Diagram, keys: Mapping[str, str]) -> list[Json]:
        found: list[Json] = []
        for name, (top, bottom) in self._drawing.bands.items():
            inside = [keys[v.id] for v in diagram.vertices() if v.group == name]
            if name and inside:
                found.append({"name": name, "top": round(top), "bottom": round(bottom)})
        return found

    def _vertex(self, vertex: Member | Channel, key: str, rows: list[str], tip: list[str]) -> Json:
        x, y = self._drawing.places[key]
        width, height = _size(rows)
        about: dict[str, Json] = {
            "key": key,
            "kind": _kind(vertex),
            "name": vertex.name,
            "rows": rows,
            "tip": tip,
            "box": [round(x - width / 2), round(y - height / 2), round(width), round(height)],
        }
        if isinstance(vertex, Member):
            about |= {"pid": vertex.pid, "stale": vertex.stale, "isTool": vertex.is_tool}
        return about

    def _edge(self, edge: Edge, keys: Mapping[str, str]) -> Json:
        arrow = keys[edge.source], keys[edge.target]
        return {
            "source": arrow[0],
            "target": arrow[1],
            "relation": edge.relation.value,
            # rounded, so that small changes are not sent
            "rate": None if edge.rate is None else float(f"{edge.rate:.3g}"),
            "topics": edge.topics,
            "way": [[round(x), round(y)] for x, y in self._drawing.ways.get(arrow, [])],
        }


def _kind(vertex: Member | Channel) -> str:
    if isinstance(vertex, Channel):
        return "service" if vertex.is_service else "topic"
    return "node" if vertex.is_node else "program"


def _texts(vertex: Member | Channel, name: str) -> list[str]:
    if isinstance(vertex, Channel):
        return [labels.printable(name), labels.printable(vertex.type_text)]
    said = ", ".join(note.partition(":")[0] for note in labels.notes(vertex))
    return [labels.printable(name), *([labels.printable(said)] if said else [])]


def _size(rows: list[str]) -> Size:
    first, *others = map(len, rows)
    letters = max(first, *(0.85 * count for count in others), 6)
    return _LETTER * letters + _PADDING, _LINE * len(rows) + 14.0
