"""The one step that drops what another rule has explained."""

from graphlib import TopologicalSorter

import pytest

from lcmtools.doctor.arbiter import arbitrate
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import finding, rule, state
from lcmtools.doctor.rules import RULES
from lcmtools.graph.model import NodeInfo

_NODE = NodeInfo("/talker", "t", "here", 7)
_DEAD = state("dead", topic="/a").of("published", "/b")


def _left(unless, title, *facts):
    """The findings of a rule beside one that claims the topics /a and /b, /talker and pid 7."""
    words = dict.fromkeys(("dead", "x", "fact", "other", "mend"), "{topic}")

    @rule("claims", remedy="", title=words, evidence="", facts=words)
    def claims(_):
        return finding(_DEAD, [state("fact", node=_NODE)])

    @rule("asks", remedy="", title=words, evidence="", facts=words, remedies=words, unless=unless)
    def asks(_):
        mends = [state("mend", topic=str(one.parts.get("topic", ""))) for one in facts]
        claimed = [one.of("topic", str(one.parts["topic"])) for one in mends]
        return finding(title, facts or None, *claimed)

    found = {one: one.examine(Evidence("udpm://")) for one in (asks, claims)}
    return [one for one in arbitrate(found, ()) if one.rule == "asks"]


_EAR = state("other", node=_NODE._replace(name="/ear"), topic="/c")
_A, _B, _C = (state("fact", topic=name) for name in ("/a", "/b", "/c"))


@pytest.mark.parametrize(
    ("unless", "title", "facts", "left"),
    [
        ({}, "x", [_A, _C], ["/a", "/c"]),
        ({"other": ""}, "x", [_A], ["/a"]),
        ({"claims": ""}, "x", [_C], None),
        ({"claims": "topic"}, "x", [_A, _C], ["/c"]),
        ({"claims": "topic"}, "x", [_A], None),
        ({"claims": "published"}, "x", [_A, _B], ["/a"]),
        ({"claims": "topic published"}, "x", [_A, _B, _C], ["/c"]),
        ({"claims": "topic"}, state("x", topic="/a"), [_C], None),
        ({"claims": "who"}, "x", [state("other", node=_NODE, topic="/d"), _EAR], ["/c"]),
        ({"claims": "pid"}, "x", [state("other", process=_NODE, topic="/c"), _C], None),
    ],
)
def test_facts_about_what_is_claimed_are_dropped_with_their_remedies(unless, title, facts, left):
    found = _left(unless, title, *facts)
    if left is None:
        assert found == []
        return
    (one,) = found
    assert [str(fact.parts["topic"]) for fact in one.facts] == left
    assert {str(remedy.parts["topic"]) for remedy in one.remedies} >= set(left)


def test_of_several_topics_the_others_are_left():
    both = state("other", node="/ear", topics=("/a", "/c"))
    (found,) = _left({"claims": "topic"}, "x", both.of("x"))
    assert [str(topic) for topic in found.facts[0].parts["topics"]] == ["/c"]


def test_no_two_rules_explain_each_other_and_all_are_there():
    ids = {one.id for one in RULES}
    assert {other for one in RULES for other in one.unless} <= ids
    order = list(TopologicalSorter({one.id: set(one.unless) for one in RULES}).static_order())
    assert set(order) == ids
