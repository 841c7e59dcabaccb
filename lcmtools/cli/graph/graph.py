"""``lcmtools graph``."""

from dataclasses import replace

import click

from lcmtools.cli.bus import in_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.graph.written import FORMATS, STDOUT, chosen
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import talk
from lcmtools.errors import UsageError
from lcmtools.graph.drawing.labels import counted
from lcmtools.graph.drawing.subgraph import DiagramOptions, members_only, select
from lcmtools.observe.channels.activity import settled
from lcmtools.observe.reading.senders import programs
from lcmtools.observe.reports.bus_diagram import diagram_of


@subcommand("graph", json_option, looking_options)
@examples(
    "graph", "graph --group -o graph.svg", "graph --format dot /husky0 | dot -Tpng -o graph.png"
)
@argument("namespace", nargs=-1, completer="bus:names")
@option(
    "--format",
    "format_",
    type=click.Choice(FORMATS),
    help="The format (else text, or by -o); svg needs Graphviz.",
)
@option(
    "-o",
    "--output",
    "file",
    metavar="FILE",
    help="Write to this file: .svg, .dot, .gv, .mmd, .md, .json or .txt.",
    completer="files",
)
@flag("--force", help="Overwrite an existing file.")
@flag("--nodes-only", help="Connect nodes directly, without topics.")
@flag("--leaf-topics", help="Include topics with one side only.")
@flag("--services", help="Include services.")
@flag("--tools", help="Include observing commands, such as echo.")
@flag(
    "-a",
    "--all",
    "everything",
    help="Include hidden names, tools, leaf topics, /clock and the like.",
)
@option(
    "--topics",
    metavar="TOPIC",
    multiple=True,
    help="Only these topics and services, by name or pattern, and the nodes that use them.",
    completer="bus:topics",
)
@option(
    "--exclude",
    "excluded",
    metavar="NAME",
    multiple=True,
    help="Leave out this name, namespace or pattern.",
    completer="bus:names",
)
@flag("--group", "is_grouped", help="Draw a frame around each namespace.")
@flag("--hz", help="Measure rates for a second.")
@option("--wait", type=duration, help="Observe plain LCM programs for this long.")
def command(
    namespace: tuple[str, ...],
    *,
    format_: str | None,
    file: str | None,
    force: bool,
    nodes_only: bool,
    topics: tuple[str, ...],
    excluded: tuple[str, ...],
    is_grouped: bool,
    hz: bool,
    wait: float | None,
    as_json: bool,
    **included: bool,
) -> None:
    """Draw the graph of nodes, plain LCM programs, and the topics that connect them.

    NAMESPACE selects nodes and topics by name, namespace or pattern ('/husky*'), with their direct
    neighbours. Left out are topics with only publishers or only subscribers that carry no messages,
    hidden names, and topics of nearly every node (/clock, /rosout). SVG is rendered by Graphviz,
    whose program dot must be installed.
    """
    output = chosen(format_, file, as_json=as_json, force=force)
    if "" in (*namespace, *topics, *excluded):
        raise UsageError("a name is empty", "lcmtools list and node list show the names")
    named = (tuple(map(in_names, words)) for words in (namespace, topics, excluded))
    parts, wanted_topics, left_out = named
    wanted = DiagramOptions(parts, wanted_topics, left_out, **included)
    with open_monitor("graph") as monitor:
        (graph, rates), url = settled(monitor, wait, hz=hz), monitor.url
    whole = diagram_of(graph, programs(graph, url), rates)
    diagram, left = select(whole, wanted)
    diagram = replace(members_only(diagram) if nodes_only else diagram, is_grouped=is_grouped)
    output.write(diagram)
    if not diagram.members:
        meant = " ".join((*namespace, *topics))
        talk(f"nothing{f' of {meant}' if meant else ''} to draw on {url}")
    if output.file != STDOUT:
        talk(f"wrote {output.file}: {counted(diagram)}")
    if left.text() and (output.format == "text" or output.file != STDOUT):
        talk(left.text())
