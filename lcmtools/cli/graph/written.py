"""A diagram in the form that is asked for, and the file that it goes to."""

import json
import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from lcmtools.cli.completion.places import write_atomically
from lcmtools.cli.output import data, lines
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.drawing import as_json, dot, mermaid, svg, text
from lcmtools.graph.drawing.diagram import Diagram

Form = Literal["text", "dot", "mermaid", "json", "svg"]
FORMS: tuple[Form, ...] = ("text", "dot", "mermaid", "json", "svg")

STDOUT = "-"
_SUFFIXES: dict[str, Form] = {
    ".txt": "text",
    ".dot": "dot",
    ".gv": "dot",
    ".mmd": "mermaid",
    ".md": "mermaid",
    ".json": "json",
    ".svg": "svg",
}
_IN_MARKDOWN = (".md",)


@dataclass(frozen=True, slots=True)
class Output:
    """Where a picture goes.

    Attributes:
        form: In what form.
        file: To which file; "-" for standard output.
    """

    form: Form
    file: str = STDOUT

    def write(self, diagram: Diagram) -> None:
        """Write a diagram.

        Raises:
            LcmtoolsError: It cannot be written.
        """
        if self.file == STDOUT and self.form == "text":
            width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
            lines(text.write(diagram, text.signs_for(sys.stdout.encoding, os.environ), width))
        elif self.file == STDOUT:
            data(_document(diagram, self.form).removesuffix("\n"))
        else:
            _write(self.file, self._for_file(diagram))

    def _for_file(self, diagram: Diagram) -> str:
        document = _document(diagram, self.form)
        is_markdown = Path(self.file).suffix.lower() in _IN_MARKDOWN
        return mermaid.fenced(document) if is_markdown and self.form == "mermaid" else document


def chosen(form: str | None, file: str | None, *, as_json: bool, force: bool) -> Output:
    """Where a picture goes, and in what form, by what is typed.

    Args:
        form: The --format option.
        file: The --output option.
        as_json: Whether --json was given.
        force: Whether a file that is there is overwritten.

    Raises:
        UsageError: The options contradict each other, no form fits the file's name, or the file is
            there already.
    """
    if as_json and form not in (None, "json"):
        raise UsageError(f"--json and --format {form} exclude each other", "leave out one of them")
    if as_json:
        form = "json"
    if file is None or file == STDOUT:
        return Output(_form(form or "text"))
    if not form:
        form = _by_suffix(file)
    if Path(file).is_file() and not force:
        raise UsageError(f"{file} is there already", "--force overwrites it")
    return Output(_form(form), file)


def _form(name: str) -> Form:
    return next(form for form in FORMS if form == name)


def _by_suffix(file: str) -> Form:
    suffix = Path(file).suffix.lower()
    if suffix in (".png", ".pdf"):
        raise UsageError(
            f"{file}: graph writes no {suffix[1:].upper()}",
            f"lcmtools graph --format dot | dot -T{suffix[1:]} -o {file}",
        )
    if suffix not in _SUFFIXES:
        known = ", ".join(_SUFFIXES)
        raise UsageError(f"{file}: its name tells no format", f"--format does, or one of {known}")
    return _SUFFIXES[suffix]


def _document(diagram: Diagram, form: Form) -> str:
    """A diagram as a whole file, ended by a newline."""
    if form == "json":
        document = json.dumps(as_json.write(diagram), ensure_ascii=False, indent=2)
        # a channel that is no UTF-8 has surrogates, which JSON writes as it escapes them
        return document.encode("utf-8", "backslashreplace").decode() + "\n"
    if form == "text":
        return "".join(f"{row}\n" for row in text.write(diagram))
    return {"dot": dot.write, "mermaid": mermaid.write, "svg": svg.write}[form](diagram)


def _write(file: str, document: str) -> None:
    path = Path(file)
    try:
        if path.exists() and not path.is_file():  # /dev/stdout, a pipe: not to be replaced
            path.write_text(document, encoding="utf-8")
        else:
            write_atomically(path, document)
    except OSError as error:
        raise LcmtoolsError(f"cannot write {file}: {error.strerror or error}") from error
