"""Questions of each shell, and its answers: whole words, whatever is in them."""

import shutil
import subprocess

import pytest

from lcmtools.cli.completion.answer import SHELLS, Request, shown
from lcmtools.cli.completion.situation import FILES, Candidate

BREAKS = " \t\n\"'><=;|&(:"
BASH = shutil.which("bash") or "bash"
PROTOTYPE = "{data: '', list: [1, 2]}"
NASTY = [
    "a b",
    "$(touch x)",
    "`touch x`",
    "it's",
    'say "hi"',
    "a;b",
    "back\\slash",
    "!!",
    "~x",
    "*",
]


def bash(line, *values):
    shell = SHELLS["bash"]
    return shell.write([Candidate(value) for value in values], shell.read([line, BREAKS]))[1:]


@pytest.mark.parametrize("value", [*NASTY, PROTOTYPE])
@pytest.mark.parametrize("quote", ["", "'", '"'])
def test_bash_reads_what_is_put_there_as_one_word(value, quote):
    (answer,) = bash(f"lcmtools echo {quote}", value)
    told = subprocess.run(
        [BASH, "-c", f"printf '%s\\n' {quote}{answer}{quote}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout == f"{value}\n"


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
@pytest.mark.parametrize("value", [*NASTY, PROTOTYPE, "/scan/ranges[0:5]"])
def test_zsh_reads_what_is_put_there_as_one_word(value):
    shell = SHELLS["zsh"]
    (line,) = shell.write([Candidate(value)], Request([], ""))
    answer = line.split("\t")[1]
    told = subprocess.run(
        [shutil.which("zsh") or "zsh", "-f", "-c", f"print -r -- {answer}"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout == f"{value}\n"


def test_bash_gets_only_what_stands_behind_a_word_break():
    assert bash("lcmtools run talker chatter:=/hus", "chatter:=/husky0/x") == ["/husky0/x"]
    assert bash("lcmtools echo --field=po", "--field=pose") == ["pose"]
    assert bash("lcmtools echo /od", "/odom") == ["/odom"]


def test_bash_is_told_when_no_blank_shall_follow():
    request = Request([], "")
    write = SHELLS["bash"].write
    assert write([Candidate("a/", is_open=True)], request)[0] == "open"
    assert write([Candidate("a")], request)[0] == "closed"
    assert write([Candidate("a/", is_open=True), Candidate("b/", is_open=True)], request)[0] == (
        "closed"
    )


def test_zsh_asks_with_words_as_typed_and_shows_help():
    shell = SHELLS["zsh"]
    request = shell.read(["pub", "'/a b'", '"', "{da"])
    assert request == Request(["pub", "/a b"], "{da", '"')
    (line,) = shell.write([Candidate("{data: ''}", "its help")], request)
    assert line == "closed\t{data: ''}\t{data: ''}  -- its help"


def test_fish_gets_a_second_word_where_it_would_put_a_blank():
    shell = SHELLS["fish"]
    assert shell.read(["echo", "'/a"]) == Request(["echo"], "/a")
    assert shell.write([Candidate("/a.b", "help", is_open=True)], Request([], "")) == [
        "/a.b\thelp",
        "/a.b.",
    ]
    assert shell.write([Candidate("a/", is_open=True)], Request([], "")) == ["a/"]


def test_what_would_move_the_cursor_or_does_not_fit_is_no_candidate():
    given = ["/a", "/a", "/a\n/b", "/a\x1b[2J", "/a\x9b", "/b", "/a\udcff"]
    found = shown([*(Candidate(value) for value in given), FILES], "/a")
    assert [one.value for one in found] == ["/a"]
