"""A rule's sentences beside it, a rule that is not asked, and the changes of wtf --watch."""

from itertools import islice

from fixtures.judging import findings, in_words, judge

from lcmtools.doctor import report
from lcmtools.doctor.evidence import Evidence, SenderFacts
from lcmtools.doctor.findings import Severity, finding, rule, state
from lcmtools.doctor.rules import RULES
from lcmtools.doctor.sentences import commands
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.wire.packet import Sender


def node(name, **values):
    ears = (Endpoint(name, Role.SUBSCRIBER),)
    return NodeInfo(name, name, "here", 1, **{"endpoints": ears, **values})


def system(*nodes):
    talker = node("/talker", endpoints=(Endpoint("/three", Role.PUBLISHER),), tool=True)
    return Evidence("udpm://", graph=Graph((talker, *nodes)))


def test_a_rule_has_its_sentences_beside_it():
    @rule(
        "too-hot",
        remedy="cool it",
        title="{count:times} too hot:",
        facts={"hot": "{sender} at {degrees:.1f}"},
        remedies={"cool": "cool it: `lcmtools cool {sender}`"},
        evidence="temperatures",
        severity=Severity.NOTE,
    )
    def temperatures_are_low(evidence):
        """Temperatures are low. Otherwise it is hot."""
        facts = [state("hot", sender=one.name, degrees=50.04) for one in evidence.senders]
        title = state("too-hot", count=len(facts))
        yield from finding(title, facts, *(state("cool", **fact.parts) for fact in facts))

    sender = SenderFacts(Sender("10.0.0.1", 1), "alice")
    (hot,) = temperatures_are_low.examine(Evidence("udpm://", senders=(sender,)))
    assert report.finding_text(hot) == [
        "NOTE once too hot:",
        " * alice at 50.0",
        "   -> cool it: lcmtools cool alice",
    ]
    assert commands(hot.remedies[0]) == ["lcmtools cool alice"]
    assert temperatures_are_low.summary == "Temperatures are low"


def test_a_rule_that_is_not_asked_takes_nothing_from_others():
    talker = node("/talker", stale=Staleness.ENDED)
    graph = Graph((node("/ear"), talker))
    evidence = Evidence(url="udpm://x", graph=graph, stale_published=frozenset({"/ear"}))
    assert "unconnected-subscriptions" not in {finding.rule for finding in judge(evidence)}
    asked = [rule for rule in RULES if rule.id != "stale-nodes"]
    assert "unconnected-subscriptions" in {finding.rule for finding in judge(evidence, asked)}


def test_errors_come_before_warnings_and_notes():
    found = findings(node("/a"), node("/b"), node("/b")._replace(id="again"))
    severities = [one.severity for one in found.values()]
    assert severities == sorted(severities, reverse=True)
    assert severities[0] is Severity.ERROR


def test_what_clears_of_a_finding_is_named():
    looks = iter([system(node("/one"), node("/two")), system(node("/two"))])
    _, changes = islice(report.watch(lambda: next(looks), RULES), 2)
    (_, cleared), (change, _) = changes
    assert report.change_text("cleared", cleared) == [
        "CLEARED The following node subscriptions are unconnected:",
        " * /one:",
        "   * /one",
    ]
    assert change == "changed"


def test_watch_reports_what_appears_changes_and_clears():
    grown = system(node("/one"), node("/two"))
    looks = iter([system(node("/one")), grown, grown, system()])
    seen = [
        [(change, found.rule, in_words(found).items) for change, found in changes]
        for changes in islice(report.watch(lambda: next(looks), RULES), 4)
    ]
    rule = "unconnected-subscriptions"
    both = (" * /one:", "   * /one", " * /two:", "   * /two")
    assert seen == [
        [("appeared", rule, both[:2])],
        [("changed", rule, both)],
        [],
        [("cleared", rule, both)],
    ]
