"""Writing a diagram in the chosen format, to standard output or a file."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from lcmtools.cli.output import data, lines
from lcmtools.errors import LcmtoolsError, MissingExtra, UsageError
from lcmtools.folders import write_whole
from lcmtools.formats.strict_json import write_json
from lcmtools.graph.drawing import as_json, dot, mermaid, text
from lcmtools.graph.drawing.diagram import Diagram

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


@dataclass(frozen=True, slots=True)
class Destination:
    """The format of a diagram, and its file; "-" for standard output."""

    format: str
    file: str = STDOUT

    def write(self, diagram: Diagram) -> None:
        """Write a diagram."""
        if self.file == STDOUT and self.format == "text":
            width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
            lines(text.write(diagram, text.signs_for(sys.stdout.encoding, os.environ), width))
        elif self.file == STDOUT:
            data(_document(diagram, self.format).removesuffix("\n"))
        else:
            document = _document(diagram, self.format)
            is_markdown = Path(self.file).suffix.lower() == ".md" and self.format == "mermaid"
            write_whole(Path(self.file), mermaid.fenced(document) if is_markdown else document)


def chosen(format_: str | None, file: str | None, *, as_json: bool, force: bool) -> Destination:
    """The output that the options --format, --output, --json and --force mean."""
    if as_json and format_ not in (None, "json"):
        raise UsageError(
            f"--json and --format {format_} exclude each other", "leave out one of them"
        )
    format_ = "json" if as_json else format_
    if file is None or file == STDOUT:
        output = Destination(format_ or "text")
    else:
        output = Destination(format_ or _by_suffix(file), file)
        if Path(file).is_file() and not force:
            raise UsageError(f"{file} already exists", "--force overwrites it")
    if output.format == "svg":
        _graphviz()
    return output


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
        said = done.stderr.decode(errors="replace").strip().partition("\n")[0]
        raise LcmtoolsError(f"Graphviz's dot failed ({said or f'exit code {done.returncode}'})")
    return done.stdout.decode()


def _graphviz() -> str:
    if path := shutil.which("dot"):
        return path
    raise MissingExtra(
        "SVG needs Graphviz's program dot, which is not installed",
        "install graphviz, or use --format dot or mermaid",
    )
