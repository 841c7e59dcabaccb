"""The page docs/wtf.md, made from the rules of wtf: ``make docs`` writes it."""

import sys
from collections.abc import Iterator, Mapping
from inspect import getdoc
from itertools import groupby
from pathlib import Path
from string import Formatter

from lcmtools.doctor.findings import Rule
from lcmtools.doctor.rules import RULES

PAGE = Path(__file__).with_name("wtf.md")
_INTRODUCTION = """\
# The rules of wtf

<!-- Made by docs/wtf_page.py from lcmtools/doctor/rules: change these, and run: make docs -->

This page lists each rule of `lcmtools wtf`: what should be true, what `wtf` prints if it is not,
its greatest severity, and the evidence that it needs. Of what `wtf` prints, the titles of findings
come first, then, after `*`, the single cases, and after `->` the remedies; words in capitals stand
for names and values. `lcmtools wtf --explain RULE` explains a rule, too; [finding
faults](finding-faults.md) shows how to use them.

Some evidence is not available:

- Without root, most of what is missing concerns programs of other users: the system shows their
  sockets, but not their names, environment variables and states. `wtf` lists the checks that it
  could not make at the end ("Not checked: ...").
- On tcpq and mpudpm, the senders of messages and losses are not visible. On Zenoh `hz` counts
  losses, but `wtf` does not.
- On systems other than Linux, sockets, processes and routes are not visible.
"""
_OPTIONAL = ("advice", "brackets", "count", "kills", "not", "wait", "with")
"""Formats of parts that are left out where there is nothing to say."""
_SHOWN = {
    "at": "{0} at ADDRESS",
    "call": "callback of {0}",
    "called": "{0} (ADDRESS)",
    "command": "COMMAND",
    "holds": "holds {0} bytes",
    "namespaces": "__ns:={0}",
    "repr": "'{0}'",
    "time": "TIME",
    "times": "{0} times",
    "use": "use",
    "work": "the callback of {0}",
}
"""The formats of parts that are not shown by their names alone."""


def page(rules: tuple[Rule, ...] = RULES) -> str:
    """Return the page: an introduction, a table of the rules, and a section for each."""
    rows = [_INTRODUCTION, "| rule | severity | what should be true |", "| --- | --- | --- |"]
    rows += [
        f"| [{rule.id}](#{rule.id}) | {rule.severity.name.lower()} | {_escaped(rule.summary)} |"
        for rule in rules
    ]
    for family, members in groupby(rules, key=lambda rule: rule.check.__module__):
        rows += ["", f"## {_heading(family)}"]
        rows += [row for rule in members for row in _section(rule)]
    return "\n".join(rows) + "\n"


def _heading(module: str) -> str:
    """The subject of a family of rules, by the first line of its module."""
    first = (getdoc(sys.modules[module]) or "").partition("\n")[0]
    subject = first.removeprefix("Rules about ").rstrip(".")
    return subject[:1].upper() + subject[1:]


def _section(rule: Rule) -> Iterator[str]:
    yield from ("", f"### {rule.id}", "", _escaped(rule.explanation), "", "```text")
    for mark, sentences in (("", rule.titles), (" * ", rule.facts), ("   -> ", rule.remedies)):
        yield from _lines(mark, sentences)
    yield from ("```", "", f"- severity: {rule.severity.name.lower()}")
    yield f"- usual remedy: {_escaped(rule.remedy)}"
    yield f"- evidence: {_escaped(rule.evidence)}"
    if rule.root_only:
        yield f"- not known without root: {_escaped(rule.root_only)}"


def _lines(mark: str, sentences: Mapping[str, str]) -> list[str]:
    """Sentences as they are printed, each once."""
    return [mark + text for text in dict.fromkeys(map(shown, sentences.values()))]


def shown(sentence: str) -> str:
    """Return a sentence with the names of its parts in capitals, and without what is optional."""
    return "".join(
        text + (_part(name, spec or "") if name else "")
        for text, name, spec, _ in Formatter().parse(sentence.replace("`", ""))
    )


def _part(name: str, spec: str) -> str:
    if spec in _OPTIONAL:
        return ""
    return _SHOWN.get(spec, "{0}").format(name.rpartition(".")[2].upper())


def _escaped(text: str) -> str:
    return text.replace("*", "\\*").replace("|", "\\|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
