"""Every command of the three labs' texts, and its siblings of ROS, has an answer.

The answer is the command of lcmtools in its place, or an error that says what to type.
"""

import shlex
from pathlib import Path

import pytest

from lcmtools.cli.completion.tree import describe
from lcmtools.cli.ros import instead
from lcmtools.errors import UsageError

DOCS = Path(__file__).parents[2] / "docs"


def _rows():
    """The part of the file, what is typed, and the answer."""
    for part in (Path(__file__).with_name("handouts.txt")).read_text().split("\n# ")[1:]:
        title, *lines = part.splitlines()
        for line in filter(None, lines):
            typed, _, answer = line.replace("\\n", "\n").partition(" => ")
            yield title, typed, answer


ROWS = list(_rows())


def translate(typed):
    """The command in place of one of ROS, or the error that there is none."""
    try:
        return instead("", shlex.split(typed)), ""
    except UsageError as error:
        return [], str(error)


@pytest.mark.parametrize(("typed", "answer"), [row[1:] for row in ROWS])
def test_every_command_has_an_answer(typed, answer, capsys):
    words, hint = translate(typed)
    if not words:
        assert answer in hint
        return
    assert words == shlex.split(answer)
    assert capsys.readouterr().err.startswith(f"{typed.split(maxsplit=1)[0]} is here: lcmtools ")
    command = describe(words[:1])
    assert command is not None
    assert not command.commands or words[1] in command.commands


@pytest.mark.parametrize(
    "word", sorted({typed.split()[0] for title, typed, _ in ROWS if "texts" in title})
)
def test_every_command_of_the_texts_is_on_a_page(word):
    pages = (DOCS / f"coming-from-ros{number}.md" for number in (1, 2))
    assert any(f"`{word}" in page.read_text() for page in pages)
