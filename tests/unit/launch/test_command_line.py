"""The words after ``lcmtools launch``."""

from pathlib import Path

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import UsageError
from lcmtools.launch.file import read_words


def test_words_are_places_arguments_and_the_namespace_in_any_order():
    typed = read_words(["a:=1", "pkg", "__ns:=husky0", "f.launch", "b:=x:=y", "c:="], None, "/")
    assert typed.places == ("pkg", "f.launch")
    assert typed.arguments == {"a": "1", "b": "x:=y", "c": ""}
    assert typed.namespace == "/husky0"


def test_namespace_is_the_tokens_the_flags_or_the_usual_one():
    assert read_words(["f"], "a", "/usual").namespace == "/usual/a"
    assert read_words(["f", "__ns:=/b"], "a", "/usual").namespace == "/b"
    assert read_words(["f", "__ns:="], None, "usual").namespace == "/usual"


def test_what_ros_has_and_lcm_has_not_is_taken_and_left():
    assert read_words(["f", "__log:=/tmp/x"], None, "/").arguments == {}


@pytest.mark.parametrize("word", ["__name:=x", "__ns:=a b", "/a:=b", "~a:=b"])
def test_wrong_word_is_refused(word):
    with pytest.raises(UsageError):
        read_words(["f", word], None, "/")


def test_an_argument_that_is_misspelt_is_no_second_file():
    with raises_saying(UsageError, "a=1", "a:=1"):
        read_words(["f", "a=1"], None, "/")


def test_a_file_may_have_such_a_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a=1").touch()
    assert read_words(["f", "a=1"], None, "/").places == ("f", "a=1")
