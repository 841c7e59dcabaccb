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
come first, then, after `*`, the single cases, and after `->` the remedies; names and values are
examples. `lcmtools wtf --explain RULE` explains a rule, too; [finding
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
    "at": "{0} at 192.168.1.7",
    "call": "the callback of {0}",
    "called": "{0} (192.168.1.7)",
    "holds": "holds {0} bytes",
    "namespaces": "__ns:={0}",
    "repr": "'{0}'",
    "times": "{0} times",
    "run": "runs",
    "use": "uses",
    "work": "the callback of {0}",
}
"""The formats of parts that are not shown by their examples alone."""
_EXAMPLES = {
    "address": "192.168.1.7",
    "argument": "cmd_vel:=/husky/cmd_vel",
    "bridge": "br0",
    "buffer_bytes": "212992",
    "bus": "udpm://239.255.76.67:7667",
    "busiest": "/husky0/scan",
    "bytes": "6220800",
    "callback": "/husky0/odometry",
    "callback_time": "30 ms",
    "chain": "INPUT",
    "channel": "POSE",
    "command": "python simple_controller.py",
    "container": "Docker container",
    "count": "3",
    "datagrams": "12",
    "depth": "10",
    "domain": "3",
    "drops": "250 datagrams dropped",
    "exception": "KeyError",
    "expected": "geometry_msgs/Twist",
    "fault": "its URL 'udpm://239.255.76.67': the port is missing",
    "fields": "frame_id",
    "firewall": "ufw",
    "frame": "base_link",
    "frames": "odom -> base_link",
    "hint": "sudo ip link set lo multicast on",
    "host": "office",
    "hosts": "office",
    "interface": "eth0",
    "interfaces": "wlan0",
    "interval": "20 ms",
    "level": "WARN",
    "limit": "4",
    "line": "192.168.1.7",
    "listened": "1",
    "listener": "lcm-sink (pid 4242)",
    "log": "ride.lcmlog",
    "longest": "1.25",
    "lost": "40",
    "megabytes_per_second": "18.4",
    "message": "'goal'",
    "messages": "120",
    "most_files": "1024",
    "name": "/husky0/driver",
    "namespace": "/husky0",
    "new": "/husky0/cmd_vel",
    "newer": "lab_msgs/Goal of /planner",
    "node": "/husky0/driver",
    "nodes": "/husky0/driver",
    "old": "/cmd_vel",
    "older": "lab_msgs/Goal of /driver",
    "open_files": "1020",
    "other": "/teleop",
    "other_sender": "/teleop",
    "other_topic": "/CMD_VEL",
    "own": "1",
    "passing": "5",
    "parents": "/odom and /map",
    "pattern": "/*/odometry",
    "percent": "94",
    "pid": "4711",
    "place": "simple_controller.py:35",
    "problem": "Network is unreachable",
    "process": "python my_driver.py",
    "program": "/husky0/driver",
    "programs": "python my_driver.py",
    "publisher": "/husky0/driver",
    "queued_bytes": "180000",
    "rate": "12",
    "ratio": "0.45",
    "reason": "it is not LCM's format",
    "options": "--rate /camera/image=4",
    "relay": "/relay",
    "seconds": "2.5 s",
    "sender": "/husky0/camera",
    "senders": "/husky0/camera",
    "sent": "1000",
    "service": "/husky0/reset",
    "software": "lcmtools 0.1.0",
    "text": "/husky0/scan: 12 of 50 ranges are nan",
    "topic": "/husky0/odometry",
    "topics": "/husky0/cmd_vel",
    "trouble": "the other bus cannot be reached",
    "ttl": "0",
    "type": "nav_msgs/Odometry",
    "types": "geometry_msgs/Twist",
    "url": "udpm://239.255.76.67:7667?ttl=1",
    "user": "alice",
    "usual": "50",
    "value": "udpm://239.255.76.67:7667?ttl=1",
    "variable": "LCM_DEFAULT_URL",
    "version": "2",
    "why": "it runs but does not answer",
}
"""Examples of the names and values in sentences."""


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
    """Return a sentence with examples of its parts, and without what is optional."""
    return "".join(
        text + (_part(name, spec or "") if name else "")
        for text, name, spec, _ in Formatter().parse(sentence.replace("`", ""))
    )


def _part(name: str, spec: str) -> str:
    if spec in _OPTIONAL:
        return ""
    example = _EXAMPLES[name.rpartition(".")[2]]
    # a sentence with a unit of its own takes the number alone
    number = example.partition(" ")[0] if spec[:1] == "." else example
    return _SHOWN.get(spec, "{0}").format(number)


def _escaped(text: str) -> str:
    return text.replace("*", "\\*").replace("|", "\\|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
