"""The committed commands of completion are those of click."""

from lcmtools.cli.completion.from_click import text
from lcmtools.cli.completion.tree import FILE


def test_committed_commands_are_fresh():
    assert FILE.read_text(encoding="utf-8") == text(), "run: make commands"
