"""The names of programs, from their command lines as the system shows them.

What only starts a program is left out: variables, ``env``, ``uv run``, an interpreter and their
options. Must not know processes: a command line is a text, in which arguments with spaces look like
several.
"""

import re

_NONE = "(?!)"  # matches nothing
LONGEST_COMMAND = 60
"""Characters of a program and its arguments in a line of text."""


def _start(name: str, with_value: str, code: str = _NONE, verb: str = "") -> str:
    """Return the pattern of a program with its options, before the first argument.

    ``with_value`` are options whose value is the next word, ``code`` those that bring the code
    itself, so that there is no file; ``verb`` is the argument without which it runs nothing.
    """
    options = rf"(?:(?:{with_value}) \S+ |(?!(?:{with_value}|{code}) )[-+]\S* )*"
    return rf"(?:\S*/)?(?:{name}) {options}{verb and f'{verb} {options}'}(?=[^-+ ])"


_UV = "-p|--(?:python|with(?:-editable|-requirements)?|project|directory|extra|(?:only-)?group)"
_WRAPPERS = (
    r"[A-Za-z_]\w*=\S* (?=\S)",
    _start("env", "-[uC]|--unset|--chdir"),
    _start("uv", f"{_UV}|--env-file|--index|--package", verb="run"),
)
_INTERPRETERS = {  # options with a value, and those that bring the code, by the interpreters' names
    r"(?:python|pypy)[\d.]*": ("-[WX]|--check-hash-based-pycs", r"-\w*c"),
    "java": ("-cp|-classpath|--class-path|-p|--module-path|--add-modules", _NONE),
    "node|nodejs": ("-[rC]|--require|--import|--loader", "-p?e|-p|--eval|--print"),
    r"(?:ruby|perl|lua)[\d.]*": ("-[Irl]", r"-\w*[eE]"),
    "mono(?:-sgen)?": (_NONE, _NONE),
    "(?:ba|da|z|k|a)?sh": ("[-+][oO]|--rcfile|--init-file", r"-\w*c"),
}
_WRAPPED = re.compile(rf"(?:{'|'.join(_WRAPPERS)})*")
_INTERPRETED = re.compile("|".join(_start(name, *how) for name, how in _INTERPRETERS.items()))
_INTERPRETER = re.compile("|".join(_INTERPRETERS))


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
    name = _file_name(_without(_WRAPPED, " ".join(command.split())).partition(" ")[0])
    return name if _INTERPRETER.fullmatch(name) else ""


def program_words(command: str) -> list[str]:
    """Return the program's name, without folders, and its arguments; empty for no command."""
    unwrapped = _without(_WRAPPED, " ".join(command.split()))
    name, *arguments = _without(_INTERPRETED, unwrapped).split() or [""]
    return [_file_name(name), *arguments] if name else []


def _without(start: re.Pattern[str], text: str) -> str:
    found = start.match(text)
    return text[found.end() :] if found else text


def _file_name(path: str) -> str:
    return path.rpartition("/")[2] or path
