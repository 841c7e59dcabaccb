"""The names of programs, from their command lines as the system shows them.

What only starts a program is seen through: an interpreter with its options, ``env``, ``uv run``.
Must not know processes: a command line is a text, in which arguments with spaces look like several.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

LONGEST_COMMAND = 60
"""Characters of a program and its arguments in a line of text."""
_ASSIGNMENT = re.compile(r"[A-Za-z_]\w*=.*")


class _Launcher(NamedTuple):
    """A kind of program whose first argument, after its options, is what it runs."""

    name: re.Pattern[str]
    with_value: frozenset[str] = frozenset()  # options whose value is the next word
    code: re.Pattern[str] | None = None  # options that bring the code itself: there is no file
    verb: str = ""  # the argument without which it runs nothing


def _launcher(name: str, with_value: str = "", code: str = "", verb: str = "") -> _Launcher:
    pattern = re.compile(code) if code else None
    return _Launcher(re.compile(name), frozenset(with_value.split()), pattern, verb)


_INTERPRETERS = (
    _launcher(r"(python|pypy)[\d.]*", "-W -X --check-hash-based-pycs", r"-\w*c"),
    _launcher("java", "-cp -classpath --class-path -p --module-path --add-modules"),
    _launcher("node|nodejs", "-r --require --import --loader -C", r"-p?e|-p|--eval|--print"),
    _launcher(r"(ruby|perl|lua)[\d.]*", "-I -r -l", r"-\w*[eE]"),
    _launcher(r"mono(-sgen)?"),
    _launcher(r"(ba|da|z|k|a)?sh", "-o +o -O +O --rcfile --init-file", r"-\w*c"),
)
_WRAPPERS = (
    _launcher("env", "-u --unset -C --chdir"),
    _launcher(
        "uv",
        "-p --python --with --with-editable --with-requirements --project --directory --extra"
        " --group --only-group --env-file --index --package",
        verb="run",
    ),
)


def short_name(command: str) -> str:
    """Return the name of a program; for an interpreter, the script's: "driver.py"."""
    return (program_words(command) or ["?"])[0]


def shortened(command: str, most: int) -> str:
    """Return the program's name and its arguments in ``most`` characters.

    Words at the end are left out if there is no room. Arguments are not changed.
    """
    text = " ".join(program_words(command))
    if len(text) <= most:
        return text
    kept = text[: most - 1].rpartition(" ")[0] or text[: most - 2]
    return f"{kept} …"


def interpreter(command: str) -> str:
    """Return the name of the interpreter that runs a script, "python3"; "" for none."""
    name, *_ = _unwrapped(command) or [""]
    return _file_name(name) if _of(name, _INTERPRETERS) else ""


def program_words(command: str) -> list[str]:
    """Return the program's name, without folders, and its arguments; empty for no command."""
    words = _unwrapped(command)
    if not words:
        return []
    launcher = _of(words[0], _INTERPRETERS)
    name, *arguments = (launcher and _run_by(launcher, words)) or words
    return [_file_name(name), *arguments]


def _unwrapped(command: str) -> list[str]:
    """Return a command line's words without wrappers and variables before the program."""
    words = command.split()
    while words:
        wrapper = _of(words[0], _WRAPPERS)
        wrapped = _run_by(wrapper, words) if wrapper else []
        if _ASSIGNMENT.fullmatch(words[0]) and words[1:]:
            wrapped = words[1:]
        if not wrapped:
            break
        words = wrapped
    return words


def _of(word: str, launchers: Sequence[_Launcher]) -> _Launcher | None:
    name = _file_name(word)
    return next((one for one in launchers if one.name.fullmatch(name)), None)


def _run_by(launcher: _Launcher, words: Sequence[str]) -> list[str]:
    """Return what a launcher runs, with its arguments; empty where that is no file or module."""
    verb, before = launcher.verb, ""
    for place, word in enumerate(words[1:], 1):
        if launcher.code and launcher.code.fullmatch(word):
            return []
        is_value, before = before in launcher.with_value, word
        if is_value or word.startswith(("-", "+")):
            continue
        if not verb:
            return list(words[place:])
        if word != verb:
            return []
        verb = ""
    return []


def _file_name(path: str) -> str:
    return path.rpartition("/")[2] or path
