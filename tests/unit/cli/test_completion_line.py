"""Which word of a command line the cursor is at."""

import pytest

from lcmtools.cli.completion.answer import scan, unquoted
from lcmtools.cli.completion.line import locate
from lcmtools.cli.completion.tree import Argument, Command, Option

BREAKS = "><=;|&(:"
URL = Option(["--lcm-url"], "lcm_url", "bus")
COLOR = Option(["--color"], "color", "", is_hidden=True)
FIELD = Option(["--field"], "fields", "field", repeats=True)
COUNT = Option(["-n"], "count", "")
ONCE = Option(["-1", "--once"], "once", None)
TREE = {
    (): Command([URL], [], {"echo": "", "run": "", "node": ""}),
    ("echo",): Command([FIELD, COUNT, ONCE, URL, COLOR], [Argument("topic", "topic")], {}),
    ("run",): Command(
        [URL],
        [
            Argument("name", "program"),
            Argument("arguments", "argument", repeats=True),
        ],
        {},
        is_mixed=False,
    ),
    ("node",): Command([], [], {"info": ""}),
    ("node", "info"): Command([], [Argument("nodes", "node", repeats=True)], {}),
}


def describe(path):
    return TREE.get(tuple(path))


@pytest.mark.parametrize(
    ("typed", "kind", "before"),
    [
        ("|", "commands", ""),
        ("--lcm-url|", "options", ""),
        ("--lcm-url |", "bus", ""),
        ("--lcm-url x |", "commands", ""),
        ("echo |", "topic", ""),
        ("echo --fi|", "options", ""),
        ("echo /a --field |", "field", ""),
        ("echo /a --field=po|", "field", "--field="),
        ("echo --color always |", "topic", ""),
        ("echo -n 3 |", "topic", ""),
        ("echo -n3 |", "topic", ""),
        ("echo -1 |", "topic", ""),
        ("echo -- -|", "topic", ""),
        ("echo /a |", "options", ""),
        ("node |", "commands", ""),
        ("node info /a |", "node", ""),
        ("run |", "program", ""),
        ("run sim --wor|", "argument", ""),
        ("run sim --world husky a|", "argument", ""),
    ],
)
def test_the_words_before_say_what_the_word_is(typed, kind, before):
    *words, word = typed.removesuffix("|").split(" ")
    place = locate(words, word, describe)
    assert (place.source or place.kind, place.before) == (kind, before)


def test_a_command_that_does_not_exist_has_no_completion():
    assert locate(["ecko"], "", describe) is None
    assert locate(["node", "bogus"], "", describe) is None


def test_what_stands_before_is_known_by_the_parameters_names():
    words = ["--lcm-url", "tcpq://", "echo", "/a", "--field", "x", "--field=y"]
    place = locate(words, "", describe)
    assert place.given == {"lcm_url": ["tcpq://"], "topic": ["/a"], "fields": ["x", "y"]}


def test_an_option_is_offered_once_unless_it_repeats_and_a_hidden_one_never():
    place = locate(["echo", "--once", "--field", "x"], "-", describe)
    offered = [name for option in place.unused_options() for name in option.names]
    assert offered == ["--field", "-n", "--lcm-url"]


@pytest.mark.parametrize(
    ("typed", "texts", "quote", "kept"),
    [
        ("lcmtools echo /a", ["lcmtools", "echo", "/a"], "", ""),
        ("lcmtools echo ", ["lcmtools", "echo", ""], "", ""),
        ("x 'a b' \"c d", ["x", "a b", "c d"], '"', ""),
        ("x a:=/b", ["x", "a:=/b"], "", "a:="),
        ("x --field='a", ["x", "--field=a"], "'", "--field="),
        ("x a\\ b", ["x", "a b"], "", ""),
        ("x '' ", ["x", "", ""], "", ""),
        ("ls | grep x; lcmtools ec", ["lcmtools", "ec"], "", ""),
        ("x $(lcmtools ec", ["lcmtools", "ec"], "", ""),
        ('x "a|b', ["x", "a|b"], '"', ""),
        ('x "a\\"b\\n', ["x", 'a"b\\n'], '"', ""),
        ("x a\\", ["x", "a\\"], "", ""),
    ],
)
def test_a_line_is_cut_as_the_shell_cuts_it(typed, texts, quote, kept):
    words = scan(typed, BREAKS)
    assert [word.text for word in words] == texts
    assert (words[-1].quote, words[-1].kept) == (quote, kept)


def test_a_single_word_is_unquoted_whatever_is_in_it():
    assert unquoted("'a b'c") == "a bc"
    assert unquoted("a;b") == "a;b"
