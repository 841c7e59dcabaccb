"""Errors in YAML: the parser's messages reworded, with a hint what to type instead."""

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import yaml

DEEPEST = 100
"""The maximum depth of nesting; far more than any document needs."""
TOO_DEEP = f"nested more than {DEEPEST} levels deep"

_WORD_BEFORE_COLON = re.compile(r"\b([A-Za-z_]\w*):([^\s:/,}\]]+)")
_WHOLE_BRACKETS = {"{": "{...}", "[": "[...]"}
_SPECIAL = "@`%|>"
_COLON_PROBLEMS = ("mapping values are not allowed", "found unexpected ':'")
_NO_COMMA = "did not find expected ','"
_IN_BRACKETS = (_NO_COMMA, "did not find expected node content")


class BadYaml(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """Text that is not accepted as YAML; ``hint`` says what to type instead.

    Lines and columns (in characters) count from 1; 0 means unknown.
    """

    def __init__(self, problem: str, line: int = 0, column: int = 0, hint: str = "") -> None:
        super().__init__(problem)
        self.problem, self.line, self.column, self.hint = problem, line, column, hint

    @classmethod
    def at(cls, mark: "yaml.Mark | None", problem: str, hint: str = "") -> "BadYaml":
        """Return the error for a position reported by PyYAML."""
        line, column = (mark.line + 1, mark.column + 1) if mark else (0, 0)
        return cls(problem, line, column, hint)


class OpenBracket(BadYaml):
    """The text ends within brackets; with more text, it may be valid."""


def quote_hint(start: str) -> str:
    """Return the hint for text whose first character has a special meaning in YAML."""
    return f"put text that begins with '{start}' in quotes"


def explained(error: "yaml.MarkedYAMLError", text: str) -> BadYaml:
    """Convert the parser's error into ours."""
    context, problem, mark = str(error.context), str(error.problem), error.problem_mark
    if problem.startswith(_IN_BRACKETS) and mark and mark.line >= text.rstrip().count("\n") + 1:
        return _open_bracket(error)
    if problem == "found unexpected end of stream" and "quoted" in context:
        return BadYaml.at(error.context_mark, "this quote is not closed")
    return _reworded(problem, mark, text)


def forbidden_character(text: str) -> BadYaml:
    """Return the error for a control character or a lone surrogate."""
    import yaml

    match = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if not match:
        return BadYaml("a character is not allowed")
    before = text[: match.start()]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    return BadYaml(f"the character U+{ord(match[0]):04X} is not allowed", line, column)


def _reworded(problem: str, mark: "yaml.Mark | None", text: str) -> BadYaml:
    lines = text.split("\n")
    line = lines[mark.line] if mark and mark.line < len(lines) else ""
    at = line[mark.column : mark.column + 1] if mark else ""
    hint = ""
    if problem.startswith(_COLON_PROBLEMS):
        hint = _colon_hint(text) or _nesting_hint(mark)
    elif at == "\t" or "tab character" in problem:
        problem, hint = "a tab cannot indent", "indent with spaces"
    elif at and at in _SPECIAL:
        problem, hint = f"text cannot begin with '{at}'", "put it in quotes"
    elif at and at in "]}" and "document start" in problem:
        problem = f"this '{at}' closes nothing"
    elif problem == "exceeded maximum nesting depth":  # 1000, since libyaml 0.2.6
        problem = TOO_DEEP
    else:
        hint = _flow_hint(problem, line)
    return BadYaml.at(mark, problem, hint)


def _nesting_hint(mark: "yaml.Mark | None") -> str:
    """Return the hint for "linear: x: 1" and for text like "note: this"."""
    if mark and mark.line:
        return "indent the keys of an entry equally"
    return "put the fields in { }, and text that has ': ' in it in quotes"


def _flow_hint(problem: str, line: str) -> str:
    """Return the hint for "a: {x: 1} b: {y: 2}" and other wrong separators."""
    if problem == "did not find expected key" and re.search(r"[}\]]\s*(?:,\s*)?\w+\s*:", line):
        return "put all fields into { } with commas between, or each on a line of its own"
    if problem in ("did not find expected key", "did not find expected '-' indicator"):
        return "indent the keys of an entry equally"
    return "put a comma between fields" if problem.startswith(_NO_COMMA) else ""


def _colon_hint(text: str) -> str:
    """Return the hint for "x:1"; "" if the text has nothing like it."""
    match = _WORD_BEFORE_COLON.search(text)
    if not match:
        return ""
    value = _WHOLE_BRACKETS.get(match[2][0], match[2])
    return f"put a space after the colon: '{match[1]}: {value}'"


def _open_bracket(error: "yaml.MarkedYAMLError") -> OpenBracket:
    """Return the error for an unclosed bracket; the parser does not always report which one."""
    mark = error.context_mark
    if not mark or not str(error.problem).startswith(_NO_COMMA):
        return OpenBracket("a bracket is not closed", 1)
    bracket = "{" if "mapping" in str(error.context) else "["
    return OpenBracket(f"this '{bracket}' is not closed", mark.line + 1, mark.column + 1)
