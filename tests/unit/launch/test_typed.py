"""Which of the words after ``lcmtools launch`` is what."""

import pytest

from lcmtools.cli.launch.typed import read_words
from lcmtools.errors import UsageError


def test_words_are_places_arguments_and_the_namespace_in_any_order() -> None:
    typed = read_words(["a:=1", "pkg", "__ns:=husky0", "f.launch", "b:=x:=y", "c:="], None, "/")
    assert typed.places == ("pkg", "f.launch")
    assert typed.arguments == {"a": "1", "b": "x:=y", "c": ""}
    assert typed.namespace == "/husky0"


def test_namespace_is_the_tokens_the_flags_or_the_usual_one() -> None:
    assert read_words(["f"], "a", "/usual").namespace == "/usual/a"
    assert read_words(["f", "__ns:=/b"], "a", "/usual").namespace == "/b"
    assert read_words(["f", "__ns:="], None, "usual").namespace == "/usual"


def test_what_ros_has_and_lcm_has_not_is_taken_and_left() -> None:
    assert read_words(["f", "__log:=/tmp/x"], None, "/").arguments == {}


@pytest.mark.parametrize("word", ["__name:=x", "__ns:=a b", "/a:=b", "~a:=b"])
def test_wrong_word_is_refused(word: str) -> None:
    with pytest.raises(UsageError):
        read_words(["f", word], None, "/")
