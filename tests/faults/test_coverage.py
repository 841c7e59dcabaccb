"""Every rule of wtf has a planted fault."""

from pathlib import Path

from lcmtools.doctor.rules import RULES

# What cannot be planted in a network namespace, and who else looks at it.
_NOT_HERE = {
    "bandwidth": "needs a slow or a wireless network card; tests/unit/doctor",
    "clocks": "needs two computers: tests/hosts",
    "container": "needs a container; tests/unit/doctor",
    "firewall": "needs a firewall; tests/unit/doctor",
    "igmp-querier": "needs a bridge between computers; tests/unit/doctor",
    "large-messages": "needs a firewall; tests/unit/doctor",
    "sending": "needs a firewall; tests/unit/doctor",
}


def test_every_rule_is_planted_or_says_why_not() -> None:
    files = Path(__file__).parent.glob("test_fault*.py")
    text = "".join(file.read_text() for file in files)
    rules = {rule.id for rule in RULES}
    planted = {rule for rule in rules if f'"{rule}"' in text}
    assert planted.isdisjoint(_NOT_HERE)
    assert planted | set(_NOT_HERE) == rules
