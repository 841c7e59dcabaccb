"""The limits of expressions: no result is much larger than what it is made of."""

import ast

import pytest
from fixtures.says import raises_saying

from lcmtools.formats.operations import ARITHMETIC, LARGEST, TEXT_METHODS, bounded, joined


def test_integers_have_at_most_64_bits():
    assert [bounded(LARGEST), bounded(-LARGEST), bounded(1e30)] == [LARGEST, -LARGEST, 1e30]
    for value in (LARGEST + 1, -LARGEST - 1):
        with raises_saying(OverflowError, "64 bits"):
            bounded(value)


@pytest.mark.parametrize(
    ("base", "exponent", "result"),
    [(2, 64, LARGEST), (3, 2, 9), (2, -1, 0.5), (2.0, 3, 8.0), (2, 65, float(2**65))],
)
def test_a_power_is_whole_while_it_has_at_most_64_bits(base, exponent, result):
    found = ARITHMETIC[ast.Pow](base, exponent)
    assert (found, type(found)) == (result, type(result))


def test_texts_grow_to_a_limit():
    assert len(joined("a" * 5000, "b" * 5000)) == 10_000
    assert TEXT_METHODS["replace"]("aba", "a", "cc") == "ccbcc"
    for make in (
        lambda: joined("a" * 5000, "b" * 5001),
        lambda: TEXT_METHODS["replace"]("aa", "a", "b" * 5001),
    ):
        with raises_saying(ValueError, "10000 characters"):
            make()
