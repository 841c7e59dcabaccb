"""Every option and argument whose words can be known declares its completer."""

from importlib import import_module

import pytest

from lcmtools.cli.completion.tree import Argument, describe

NOT_KNOWN = {
    "bag filter words",
    "bag rename names",
    "bag rerun program",
    "msg find-field name",
    "pkg add-node name",
    "pkg create name",
    "pkg create node",
    "pub name",
    "sim set-pose words",
    "sim set-rate rate",
    "sim spawn robot",
    "sim spawn words",
    "sim step steps",
    "tf echo source",
    "tf echo target",
}
"""Arguments, and options with such a name, that may be any word."""
KNOWN_OPTIONS = {"fields", "file", "lcm_url", "node", "ns", "output", "remap", "topics"}


def parameters():
    """Every option with a value and every argument, with the words of its command before it."""
    waiting = [""]
    while waiting:
        path = waiting.pop()
        command = describe(path.split())
        assert command is not None
        waiting += [f"{path} {name}".strip() for name in command.commands if name != "topic"]
        for one in (*command.options, *command.arguments):
            yield f"{path} {one.parameter}".strip(), one


PARAMETERS = dict(parameters())


def test_words_that_can_be_known_are_completed():
    arguments = {name for name, one in PARAMETERS.items() if isinstance(one, Argument)}
    options = {name for name, one in PARAMETERS.items() if name.split()[-1] in KNOWN_OPTIONS}
    without = {name for name in arguments | options if PARAMETERS[name].source == ""}
    assert {name.replace("interface", "msg") for name in without} <= NOT_KNOWN


def test_every_completer_that_is_declared_exists():
    homes = {one.source for one in PARAMETERS.values() if isinstance(one.source, str)}
    for home in homes - {"", "files"}:
        module, _, function = home.partition(":")
        full = module if "." in module else f"lcmtools.cli.completion.{module}"
        assert callable(getattr(import_module(full), function))


@pytest.mark.parametrize(
    ("parameter", "source"),
    [
        ("echo words", "messages:topics_and_fields"),
        ("pub values", "messages:prototypes"),
        ("spy topics", "bus:names"),
        ("spy column", [["channel"], ["type"]]),
        ("graph excluded", "bus:names"),
        ("param set words", "bus:parameters"),
        ("param dump words", "bus:nodes_and_files"),
        ("param load words", "bus:nodes_after_file"),
        ("sim state robot", "bus:robots"),
        ("lab check controller", "files"),
        ("lab skeleton name", "lcmtools.labs.commands.completion:skeletons"),
        ("launch node", "runnables:launched_nodes"),
    ],
)
def test_completer_is_the_one_for_the_parameters_words(parameter, source):
    declared = PARAMETERS[parameter].source
    assert declared == source if isinstance(source, str) else declared[:2] == source
