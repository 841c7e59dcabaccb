"""Results of tests as JUnit's XML, in the schema of Jenkins and GitLab."""

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree as ET


class Case(NamedTuple):
    """A test."""

    group: str
    name: str
    failure: str = ""  # the message of a failure; "" if it passed
    details: Sequence[str] = ()  # lines below the message
    skipped: str = ""  # the reason why it says nothing of its own


class Suite(NamedTuple):
    """Tests that belong together, and how long they took [s]."""

    name: str
    cases: Sequence[Case]
    seconds: float


def junit(name: str, suites: Sequence[Suite]) -> str:
    """Return the text of a file."""
    root = ET.Element("testsuites", name=name)
    for suite in suites:
        counts = {
            "tests": str(len(suite.cases)),
            "failures": str(sum(bool(one.failure) for one in suite.cases)),
            "skipped": str(sum(bool(one.skipped) for one in suite.cases)),
        }
        time = f"{suite.seconds:.1f}"
        part = ET.SubElement(root, "testsuite", counts, name=suite.name, time=time)
        for one in suite.cases:
            case = ET.SubElement(part, "testcase", classname=one.group, name=one.name)
            if one.skipped:
                ET.SubElement(case, "skipped", message=_legal(one.skipped))
            elif one.failure:
                failure = ET.SubElement(case, "failure", message=_legal(one.failure))
                failure.text = _legal("\n".join(one.details))
    ET.indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ET.tostring(root, "unicode")}\n'


def _legal(text: str) -> str:
    """Replace the characters that XML cannot contain."""
    return "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)
