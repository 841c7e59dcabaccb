"""Mistakes cost one line on standard error, which says what, where and what to do.

The mistakes are in the folder mistakes, as in a terminal.
"""

import re
import shlex
import sysconfig
from pathlib import Path

import pytest
from man_pages import commands

import lcmtools
from lcmtools.bus.tap import Tap
from lcmtools.bus.url import parse_url
from lcmtools.cli.main import main
from lcmtools.names import is_hidden

_VARIABLE = re.compile(r"\w+=")
COMMANDS_WITH_BUS = [
    ("list", ""),
    ("info", "a"),
    ("echo", "a"),
    ("hz", "a"),
    ("bw", "a"),
    ("delay", "a"),
    ("find", "String"),
    ("type", "a"),
    ("pub", "a std_msgs/String x"),
    ("node list", ""),
    ("node info", "a"),
    ("node ping", "a"),
    ("node machine", ""),
    ("spy", "--once"),
    ("wtf", ""),
    ("run", "talker"),
]


def read_mistakes():
    """The line that is typed, the exit code, and the line that comes back."""
    for file in sorted((Path(__file__).parent / "mistakes").glob("*.txt")):
        code = 2
        lines = iter(file.read_text().splitlines())
        for line in lines:
            if line.startswith("# exit code "):
                code = int(line.removeprefix("# exit code "))
            elif line.startswith("$ "):
                yield line.removeprefix("$ "), code, next(lines)


MISTAKES = list(read_mistakes())


@pytest.fixture(autouse=True)
def _files(tmp_path, monkeypatch):
    """A folder with files that are no messages."""
    (tmp_path / "empty.yaml").touch()
    (tmp_path / "dashes.yaml").write_text("---\n---\n")
    (tmp_path / "latin1.yaml").write_bytes(b"data: caf\xe9\n")
    (tmp_path / "second_is_bad.yaml").write_text("data: one\n---\ndata: [2]\n")
    (tmp_path / "good.yaml").write_text("data: one\n")
    (tmp_path / "mine.py").touch()
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def complaint(capsys, monkeypatch):
    """Runs a command line; gives its exit code and the one line that it wrote."""

    def run(typed):
        words = shlex.split(typed)
        while _VARIABLE.match(words[0]):
            name, _, value = words.pop(0).partition("=")
            monkeypatch.setenv(name, value)
        code = main(words[1:] if words[0] == "lcmtools" else words)
        out, error = capsys.readouterr()
        assert out == ""
        assert error.count("\n") == 1, error
        return code, error.removesuffix("\n").replace(sysconfig.get_path("purelib"), "PACKAGES")

    yield run
    lcmtools.shutdown()  # a node's program that failed leaves this to the end of its process


@pytest.mark.parametrize(("typed", "code", "line"), MISTAKES, ids=[row[0] for row in MISTAKES])
def test_mistake_costs_one_line(typed, code, line, complaint, bus_url, monkeypatch):
    if "--domain" not in typed:  # a URL would win over it
        monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    with Tap(parse_url(bus_url)) as tap:
        assert complaint(typed) == (code, line)
        sent = {packet.channel for packet in tap.receive(0.0)}
    assert {channel for channel in sent if not is_hidden(channel)} == set()  # nothing was sent


def test_there_are_mistakes_of_every_kind_for_every_command():
    wrong = {typed.partition("lcmtools ")[2] for typed, _, _ in MISTAKES}
    paths = [" ".join(words[1:]) for words in commands() if words[1:2] != ("topic",)]
    assert [
        path for path in paths if not any(f"{typed} ".startswith(path) for typed in wrong)
    ] == []
    assert len(MISTAKES) >= 150


@pytest.mark.parametrize(
    ("typed", "command", "option"),
    [
        ("--bogus", "", "--bogus"),
        ("list --al", " list", "--al"),
        ("echo a --tiemout 3", " echo", "--tiemout"),
        ("pub /a std_msgs/String x --onec", " pub", "--onec"),
        ("pub /a std_msgs/String --rat 5 x", " pub", "--rat"),
        ("run --bogus", " run", "--bogus"),
        ("msg list --domain 3", " msg list", "--domain"),
    ],
)
def test_unknown_option_costs_one_line_and_exit_code_2(typed, command, option, complaint):
    code, line = complaint(typed)
    assert code == 2
    # what click says of it, and what it suggests instead, depends on click's version
    start = rf"lcmtools{command}: no such option:? '?{option}\b.*"
    assert re.fullmatch(rf"{start} \(see lcmtools{command} --help\)", line)


@pytest.mark.parametrize(("command", "arguments"), COMMANDS_WITH_BUS)
def test_bad_domain_in_the_environment_is_named(command, arguments, complaint, monkeypatch):
    monkeypatch.setenv("LCMTOOLS_DOMAIN", "x")
    line = "LCMTOOLS_DOMAIN 'x' is not a domain; a domain is a number from 0 to 232"
    name = "run talker" if command == "run" else command
    assert complaint(f"{command} {arguments}") == (2, f"lcmtools {name}: {line}")


@pytest.mark.parametrize(("command", "arguments"), COMMANDS_WITH_BUS)
def test_url_without_a_port_in_the_environment_is_named(command, arguments, complaint, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", "udpm://239.255.76.67")
    line = "the port is missing; write 'udpm://239.255.76.67:7667?ttl=0'"
    name = "run talker" if command == "run" else command
    assert complaint(f"{command} {arguments}") == (
        2,
        f"lcmtools {name}: LCM_DEFAULT_URL 'udpm://239.255.76.67': {line}",
    )


def test_channel_that_is_no_utf_8_is_refused(complaint):
    assert complaint("pub --literal a\udcff std_msgs/String x") == (
        2,
        "lcmtools pub: 'a\\udcff' is not UTF-8; nodes cannot use other channels",
    )


def test_url_that_wins_over_a_domain_says_so(capsys, bus_url):
    assert main(["list", "--domain", "3", "--lcm-url", bus_url]) == 0
    error = capsys.readouterr().err
    assert error.splitlines()[0] == "lcmtools: --domain 3 has no effect: --lcm-url takes precedence"


@pytest.mark.parametrize("command", ["list", "config", "relay {url} {url}"])
def test_an_option_of_a_url_that_has_no_effect_is_named(command, bus_url, capsys, monkeypatch):
    url = f"{bus_url}&tt1=1"
    monkeypatch.setenv("LCM_DEFAULT_URL", url)
    main(command.format(url=url).split())
    note = f"{url}: tt1=1 has no effect; did you mean ttl?"
    source = "BUS" if "relay" in command else "LCM_DEFAULT_URL"
    assert capsys.readouterr().err.splitlines()[0] == f"lcmtools: {source} {note}"


def test_fault_of_its_own_is_one_line_and_a_traceback_only_with_debug(complaint, monkeypatch):
    def fail():
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr("lcmtools.cli.msg.type_names", fail)
    code, line = complaint("msg list")
    assert code == 1
    assert line == (
        "lcmtools msg list: a fault of lcmtools (ZeroDivisionError: by zero);"
        " lcmtools --debug shows where"
    )
    monkeypatch.setenv("LCMTOOLS_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["msg", "list"])
