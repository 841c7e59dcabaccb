"""YAML as nodes: places, quotes, aliases, and one document of a file."""

import pytest

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_yaml import read_documents, read_file


def only(text):
    (node,) = read_documents(text)
    assert node is not None
    return node


def test_every_value_has_its_place_and_its_keys_line():
    mapping = only("\na: 1\nb:\n  - x\n  - {c: y}\n").value
    assert isinstance(mapping, dict)
    assert (mapping["a"].line, mapping["a"].key_line) == (2, 2)
    assert (mapping["b"].line, mapping["b"].key_line) == (4, 3)
    items = mapping["b"].value
    assert isinstance(items, list)
    assert [item.line for item in items] == [4, 5]


def test_scalars_stay_text_and_nothing_is_what_is_not_quoted():
    node = only("[1e3, no, 007, ~, null, '', 'null', !!str null, !!int 5, !!binary aGk=]")
    texts = ["1e3", "no", "007", None, None, "", "null", "null", "5", b"hi"]
    assert node.plain() == texts


def test_aliases_keep_the_anchors_place_and_have_keys_of_their_own():
    mapping = only("a: &x {k: v}\nb: *x\n").value
    assert isinstance(mapping, dict)
    assert mapping["b"].plain() == {"k": "v"}
    assert (mapping["b"].line, mapping["b"].key_line) == (1, 2)


@pytest.mark.parametrize("text", ["", "# nothing", "---\n---\n", "~"])
def test_a_file_may_say_nothing(text):
    assert read_file(text, "f") is None


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("a: 1\na: 2", "f:2: not YAML: 'a' is given twice; leave one of them out"),
        ("a: 1\n\tb: 2", "f:2: not YAML: a tab cannot indent; indent with spaces"),
        ("a: {<<: b}", "f:1: not YAML: '<<' cannot merge other keys here; write them out"),
        ("a: &a [*a]", "f:1: not YAML: unknown alias '*a'; put text that begins with '*' in qu"),
        ("a: [", "f:1: not YAML: a bracket is not closed"),
        ("a: 1\n---\nb: 2", "f:3: another document begins, but only one is expected"),
    ],
)
def test_a_mistake_is_named_with_file_and_line(text, complaint):
    with pytest.raises(InvalidFile) as caught:
        read_file(text, "f")
    assert str(caught.value).startswith(complaint)
