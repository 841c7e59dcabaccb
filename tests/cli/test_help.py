"""Help of every command, and the names that it is found by."""

import importlib.metadata
import sys

import click
import pytest

from lcmtools import __version__
from lcmtools.cli.main import main, root


def tree(command, path=()):
    """The words after "lcmtools" of every command, aliases too."""
    yield path
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command._entries:
            below = command.get_command(context, name)
            assert below is not None
            yield from tree(below, (*path, name))


COMMANDS = list(tree(root))
Captured = pytest.CaptureFixture[str]
GROUPS = [path for path in COMMANDS if any(other[:-1] == path for other in COMMANDS if other)]


def test_the_tree_has_the_commands_of_rostopic_and_rosnode():
    verbs = {"list", "info", "echo", "pub", "hz", "type", "find", "bw", "delay"}
    assert {(verb,) for verb in verbs} <= set(COMMANDS)
    assert {("topic", verb) for verb in verbs} <= set(COMMANDS)
    assert {("node", verb) for verb in ("list", "info", "ping", "machine", "cleanup")} <= set(
        COMMANDS
    )
    assert {("msg", verb) for verb in ("list", "show", "md5", "package", "packages")} <= set(
        COMMANDS
    )
    assert {("srv", "list"), ("srv", "show"), ("wtf",), ("run",)} <= set(COMMANDS)


def test_help_has_two_examples_that_begin_as_one_types_them(capsys):
    for path in COMMANDS:
        assert main([*path, "--help"]) == 0, path
        text, error = capsys.readouterr()
        assert error == ""
        assert text.startswith(" ".join(("Usage: lcmtools", *path)))
        _, _, examples = text.partition("Examples:\n")
        lines = [line.strip() for line in examples.split("\n\n")[0].splitlines()]
        assert len(lines) >= 2, path
        for line in lines:
            tool, *words = line.split()[:3]
            assert tool == "lcmtools", line
            assert tuple(words if tuple(words[:1]) in GROUPS else words[:1]) in COMMANDS, line
        assert main([*path, "-h"]) == 0, path
        assert capsys.readouterr().out == text


def test_help_of_a_group_has_a_line_for_each_command(capsys):
    for group in GROUPS:
        main([*group, "--help"])
        _, _, table = capsys.readouterr().out.partition("Commands:\n")
        listed = {line.split()[0] for line in table.split("\n\n")[0].splitlines()}
        below = {path[-1] for path in COMMANDS if path and path[:-1] == group}
        is_msg = group in (("msg",), ("interface",))
        aliases = {"md5", "info"} if is_msg else set()
        aliases |= {("pkg",): {"prefix"}, ("srv",): {"info"}}.get(group, set())
        aliases |= set() if group else {"topic", "doctor", "interface"}
        assert listed == below - aliases, group


def test_usage_has_an_argument_with_a_default_in_brackets():
    for path in COMMANDS:
        command = root
        for word in path:
            assert isinstance(command, click.Group)
            found = command.get_command(click.Context(command), word)
            assert found is not None
            command = found
        context = click.Context(command)
        for argument in (one for one in command.params if isinstance(one, click.Argument)):
            if isinstance(argument.default, str):
                assert "[" in argument.make_metavar(context), path


@pytest.mark.parametrize(
    "verb", ["list", "info", "echo", "pub", "hz", "type", "find", "bw", "delay"]
)
def test_topic_verbs_are_the_same_commands_with_and_without_topic(verb):
    context = click.Context(root)
    topic = root.get_command(context, "topic")
    assert isinstance(topic, click.Group)
    assert topic.get_command(context, verb) is root.get_command(context, verb)


def test_version_names_lcmtools_lcm_and_python(capsys):
    assert main(["--version"]) == 0
    python = ".".join(map(str, sys.version_info[:3]))
    lcm = importlib.metadata.version("lcm")
    assert capsys.readouterr().out == f"lcmtools {__version__} (lcm {lcm}, Python {python})\n"


def test_without_a_command_the_help_goes_to_standard_error_with_exit_code_2(capsys):
    assert main([]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert "Commands:" in error
