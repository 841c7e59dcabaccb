"""``lcmtools graph``."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import click

from lcmtools.cli.bus import in_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import json_option, looking_options
from lcmtools.cli.output import write_data, write_lines, write_note
from lcmtools.errors import LcmtoolsError, MissingExtra, UsageError
from lcmtools.folders import write_whole
from lcmtools.formats.strict_json import write_json
from lcmtools.graph.drawing import as_json, dot, mermaid, text
from lcmtools.graph.drawing.diagram import Diagram
from lcmtools.graph.drawing.labels import counted
from lcmtools.graph.drawing.subgraph import DiagramOptions, members_only, select
from lcmtools.observe.channels.activity import settled
from lcmtools.observe.reading.senders import programs
from lcmtools.observe.reports.bus_diagram import diagram_of

FORMATS = ("text", "dot", "mermaid", "json", "svg")
STDOUT = "-"
_SUFFIXES = {
    ".txt": "text",
    ".dot": "dot",
    ".gv": "dot",
    ".mmd": "mermaid",
    ".md": "mermaid",
    ".json": "json",
    ".svg": "svg",
}


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
    format_, file = chosen_output(format_, file, as_json=as_json, force=force)
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
    write(diagram, format_, file)
    if not diagram.members:
        meant = " ".join((*namespace, *topics))
        write_note(f"nothing{f' of {meant}' if meant else ''} to draw on {url}")
    if file != STDOUT:
        write_note(f"wrote {file}: {counted(diagram)}")
    if left.text() and (format_ == "text" or file != STDOUT):
        write_note(left.text())


def chosen_output(
    format_: str | None, file: str | None, *, as_json: bool, force: bool
) -> tuple[str, str]:
    """Return the format and the file that the options mean; "-" is standard output."""
    if as_json and format_ not in (None, "json"):
        raise UsageError(
            f"--json and --format {format_} exclude each other", "leave out one of them"
        )
    format_ = "json" if as_json else format_
    if file is None or file == STDOUT:
        format_, file = format_ or "text", STDOUT
    else:
        format_ = format_ or _by_suffix(file)
        if Path(file).is_file() and not force:
            raise UsageError(f"{file} already exists", "--force overwrites it")
    if format_ == "svg":
        _graphviz()
    return format_, file


def write(diagram: Diagram, format_: str, file: str) -> None:
    """Write a diagram to a file, or to standard output."""
    if file == STDOUT and format_ == "text":
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        write_lines(text.write(diagram, text.signs_for(sys.stdout.encoding, os.environ), width))
    elif file == STDOUT:
        write_data(_document(diagram, format_).removesuffix("\n"))
    else:
        document = _document(diagram, format_)
        is_markdown = Path(file).suffix.lower() == ".md" and format_ == "mermaid"
        write_whole(Path(file), mermaid.fenced(document) if is_markdown else document)


def _by_suffix(file: str) -> str:
    suffix = Path(file).suffix.lower()
    if suffix in (".png", ".pdf"):
        raise UsageError(
            f"{file}: graph does not write {suffix[1:].upper()}",
            f"lcmtools graph --format dot | dot -T{suffix[1:]} -o {file}",
        )
    if suffix not in _SUFFIXES:
        known = ", ".join(_SUFFIXES)
        raise UsageError(f"{file}: unknown file format", f"use --format, or one of {known}")
    return _SUFFIXES[suffix]


def _document(diagram: Diagram, format_: str) -> str:
    if format_ == "json":
        return write_json(as_json.write(diagram), indent=2) + "\n"
    if format_ == "text":
        return "".join(f"{row}\n" for row in text.write(diagram))
    if format_ == "mermaid":
        return mermaid.write(diagram)
    return dot.write(diagram) if format_ == "dot" else _svg(dot.write(diagram))


def _svg(document: str) -> str:
    done = subprocess.run(  # noqa: S603 - our own document
        [_graphviz(), "-Tsvg"], input=document.encode(), capture_output=True, check=False
    )
    if done.returncode:
        message = done.stderr.decode(errors="replace").strip().partition("\n")[0]
        raise LcmtoolsError(f"Graphviz's dot failed ({message or f'exit code {done.returncode}'})")
    return done.stdout.decode()


def _graphviz() -> str:
    if path := shutil.which("dot"):
        return path
    raise MissingExtra(
        "SVG needs Graphviz's program dot, which is not installed",
        "install graphviz, or use --format dot or mermaid",
    )
