"""Words that begin with a dash and are values."""

import pytest

from lcmtools.cli.completion.line import is_value
from lcmtools.cli.negative_numbers import bare, shielded


@pytest.mark.parametrize(
    "word",
    ["-1", "-0.5", "-.5", "-1e3", "-inf", "-.INF", "-nan", "-.NaN", "- a", "-\n  b", "---\na"],
)
def test_numbers_and_lists_are_values(word):
    assert is_value(word)
    assert shielded(word) == f" {word}"
    assert bare(f" {word}") == word


@pytest.mark.parametrize("word", ["-", "--", "-v", "--json", "-name", "-nano", "---", "1", "a-1"])
def test_other_words_stay_as_they_are(word):
    assert not is_value(word)
    assert shielded(word) == word
    assert bare(f" {word}") == f" {word}"
