"""Sizes, ages, rates, jitter, losses as text: the page (tests/gui) has the same table."""

import json
from pathlib import Path

import pytest

from lcmtools.graph.drawing.labels import rate_text
from lcmtools.observe.channels.columns import age_text, jitter_text, loss_text
from lcmtools.observe.reports.describe import size_text

TABLE = json.loads((Path(__file__).parents[2] / "fixtures" / "texts.json").read_text())
TEXTS = {
    "size": size_text,
    "age": age_text,
    "rate": rate_text,
    "loss": loss_text,
    "jitter": jitter_text,
}


@pytest.mark.parametrize("kind", TABLE)
def test_numbers_as_text(kind):
    for value, text in TABLE[kind]:
        assert TEXTS[kind](value) == text, value
