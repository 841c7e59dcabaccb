"""Which words that begin with a dash are values."""

import pytest

from lcmtools.cli.dashes import Dashes


@pytest.mark.parametrize(
    "word",
    ["-1", "-0.5", "-.5", "-1e3", "-inf", "-.INF", "-nan", "-.NaN", "- a", "-\n  b", "---\na"],
)
def test_numbers_and_lists_are_values(word: str) -> None:
    assert Dashes().is_value(word)
    assert Dashes().shielded(word) == f" {word}"
    assert Dashes().bare(f" {word}") == word


@pytest.mark.parametrize("word", ["-", "--", "-v", "--json", "-name", "-nano", "---", "1", "a-1"])
def test_other_words_stay_as_they_are(word: str) -> None:
    assert not Dashes().is_value(word)
    assert Dashes().shielded(word) == word
    assert Dashes().bare(f" {word}") == f" {word}"


def test_a_command_may_take_less() -> None:
    dashes = Dashes(but="-1[a-z]+")
    assert not dashes.is_value("-1v")
    assert dashes.is_value("-1v 2")
    assert dashes.is_value("-1")
