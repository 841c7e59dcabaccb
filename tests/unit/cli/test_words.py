"""The words that a command takes for its last argument, for options, and for their values."""

import click
import pytest

from lcmtools.cli.negative_numbers import WITHOUT_END, CommandWithWords


class _Command(CommandWithWords):
    may_stand_alone = ("--wait",)


PARAMETERS = [
    click.Argument(["words"], nargs=-1),
    click.Option(["-n", "--name"]),
    click.Option(["--wait"]),
    click.Option(["-v"], is_flag=True),
]
ONCE = click.Option(["-1", "--once"], is_flag=True)


def parsed(words, *more):
    """The parameters of a command line."""
    context = _Command("it", params=[*PARAMETERS, *more]).make_context("it", list(words))
    return {name: value for name, value in context.params.items() if value}


@pytest.mark.parametrize(
    "value", ["-5", "-0.5", "-.5e3", "-inf", "-.INF", "-nan", "-.nan", "- a\n- b", "--- \na"]
)
def test_every_command_takes_the_same_for_values(value):
    assert parsed(["/a", value, "-v"]) == {"words": ("/a", value), "v": True}
    assert parsed(["/a", "--", value]) == {"words": ("/a", value)}


@pytest.mark.parametrize("value", ["-1", "-0.5", "- a"])
def test_what_follows_an_option_is_its_value_as_it_is(value):
    assert parsed(["-n", value, "/a"]) == {"words": ("/a",), "name": value}


def test_an_option_may_stand_alone():
    assert parsed(["--wait", "/a"]) == {"words": ("/a",), "wait": WITHOUT_END}
    assert parsed(["--wait=2", "/a"]) == {"words": ("/a",), "wait": "2"}


def test_the_first_minus_one_is_the_option_of_pub():
    assert parsed(["-1", "/a", "-1"], ONCE) == {"words": ("/a", "-1"), "once": True}
    assert parsed(["/a", "--", "-1"], ONCE) == {"words": ("/a", "-1")}
    assert parsed(["/a", "-n", "-1", "-1"], ONCE) == {"words": ("/a",), "name": "-1", "once": True}
    assert parsed(["/a", "-1v"], ONCE) == {"words": ("/a",), "once": True, "v": True}
    assert parsed(["/a", "-1v 2"], ONCE) == {"words": ("/a", "-1v 2")}
