"""Every rule of wtf finds its fault in evidence, in the words and the JSON that a case tells."""

import json
from functools import cache
from graphlib import TopologicalSorter

import pytest

from lcmtools.doctor.rules import RULES
from tests.doctor.cases import FILES, blocks, render

_BLOCKS = {file.stem: blocks(file.read_text()) for file in FILES}
_CASES = [(name, number) for name, found in _BLOCKS.items() for number in range(1, len(found))]
_ELSEWHERE = {  # kinds that need types of the user's own, and are asserted in tests/types
    *(("facts", kind) for kind in ("appended", "differ-in", "has-more")),
    *(("titles", "unknown-type"), ("remedies", "correct-file")),
}


@cache
def _now(name):
    return blocks(render("".join(_BLOCKS[name])))


def _title(case):
    name, number = case
    return f"{name}: {_BLOCKS[name][number].splitlines()[0][3:]}"


@pytest.mark.parametrize("case", _CASES, ids=_title)
def test_a_case(case):
    name, number = case
    assert _now(name)[number].splitlines() == _BLOCKS[name][number].splitlines()


def test_every_sentence_of_every_rule_has_a_case_with_its_json():
    told = set()
    for line in "".join(map("".join, _BLOCKS.values())).splitlines():
        if line.startswith('> {"rule"'):
            record = json.loads(line[2:])
            told |= {("titles", record["values"]["kind"]), ("rule", record["rule"])}
            told |= {("facts", one["kind"]) for one in record.get("facts", ())}
            told |= {("remedies", one["kind"]) for one in record.get("actions", ())}
    tables = ("titles", "facts", "remedies")
    kinds = {(table, kind) for one in RULES for table in tables for kind in getattr(one, table)}
    assert kinds | {("rule", one.id) for one in RULES} == told | _ELSEWHERE


@pytest.mark.parametrize("table", ["titles", "facts", "remedies"])
def test_a_kind_has_one_sentence_in_all_rules(table):
    sentences = {}
    for one in RULES:
        for kind, sentence in getattr(one, table).items():
            assert sentences.setdefault(kind, sentence) == sentence


def test_rules_have_explanations_and_remedies_and_no_two_explain_each_other():
    ids = {one.id for one in RULES}
    assert len(ids) == len(RULES)
    for one in RULES:
        assert one.explanation.endswith((".", ")")), one.id
        assert one.remedy, one.id
        assert one.summary, one.id
    order = TopologicalSorter({one.id: set(one.unless) for one in RULES}).static_order()
    assert set(order) == ids
