"""The rules, one file a family. A new rule is a function, listed in ``RULES``."""

from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Rule
from lcmtools.doctor.rules.bus import bus_works, datagrams_are_lcm, something_is_there
from lcmtools.doctor.rules.connections import publications_are_heard, subscriptions_are_fed
from lcmtools.doctor.rules.nodes import nodes_answer, nodes_have_names_of_their_own
from lcmtools.doctor.rules.types import topics_have_one_type

RULES: tuple[Rule, ...] = (
    bus_works,
    something_is_there,
    datagrams_are_lcm,
    nodes_answer,
    nodes_have_names_of_their_own,
    topics_have_one_type,
    subscriptions_are_fed,
    publications_are_heard,
)


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Everything that the rules find, gravest first. Where there is no bus, only that."""
    findings = [finding for rule in RULES for finding in rule(evidence)]
    yield from sorted(findings, key=lambda finding: -finding.severity)
