"""docs/commands.md has the commands as they are."""

from commands_page import PAGE, page
from man_pages import commands
from ros_equivalents import EQUIVALENTS


def test_committed_page_is_fresh():
    assert PAGE.read_text(encoding="utf-8") == page(), "run: make docs"


def test_each_command_is_on_the_page_once():
    text = PAGE.read_text(encoding="utf-8")
    rows = [row for row in text.splitlines() if row.startswith("| `lcmtools ")]
    names = [" ".join(words) for words in commands() if words[1:] and words[1] != "topic"]
    commands_alone = [name for name in names if f"## {name}\n" not in text]
    for name in commands_alone:
        assert sum(row.startswith((f"| `{name} ", f"| `{name}`")) for row in rows) == 1, name
    assert len(rows) == len(commands_alone)


def test_equivalents_of_ros_are_those_of_commands():
    assert EQUIVALENTS.keys() <= {" ".join(words[1:]) for words in commands()}
