"""Files of parameters: values with their keys, file and line."""

import pytest

from lcmtools.errors import InvalidFile
from lcmtools.publish.parameter_file import read_leaves


def test_yaml_has_the_lines_of_its_values():
    leaves = read_leaves("driver:\n  kp: 0.5\n  names: [a, b]\n", "gains.yaml")
    assert [(leaf.path, leaf.value, leaf.place) for leaf in leaves] == [
        (("driver", "kp"), "0.5", "gains.yaml:2"),
        (("driver", "names"), ["a", "b"], "gains.yaml:3"),
    ]


def test_json_may_have_escapes_that_yaml_does_not_have():
    text = r'{"driver": {"name": "\ud83d\ude00\/\u0085", "loud": true, "gains": [1, 0.5]}}'
    values = {leaf.path[-1]: leaf.value for leaf in read_leaves(text, "a.json")}
    assert values == {"name": "\U0001f600/\x85", "loud": "true", "gains": ["1", "0.5"]}


@pytest.mark.parametrize("text", [r'{"a": "\ud83d"}', '{"a": ' * 100_000, "{"])
def test_what_is_neither_is_refused(text):
    with pytest.raises(InvalidFile, match=r"a\.json:1: not YAML"):
        read_leaves(text, "a.json")
