"""Running lcm-gen, which comes with the lcm package, on one file at a time.

Belongs here: finding it, running it, and what its complaints mean. One file at a time, because it
lets the package of a file count for the next one that names none. Must not know what is generated.
"""

import os
import re
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

from lcmtools.errors import MissingExtra
from lcmtools.messages.type_source import Problem

_LONGEST = 30.0
"""Seconds that one file may take; it is milliseconds usually."""
_HINTS = {
    "expected token {": "lcm-gen wants a space or a new line before '{'",
    "expected token ;": "a ';' is missing before this",
    "expected token }": "a '}' is missing, or lacks a space before it",
    "missing struct token.": "a file is  package name;  and then  struct Name { ... }",
    "array sizes must": "declare the size before it:  int32_t size;  double values[size];",
    "unknown variable array": "declare  int32_t size;  above the array",
}


@cache
def find_lcm_gen() -> str:
    """The path of lcm-gen.

    Raises:
        MissingExtra: There is none.
    """
    spec = find_spec("lcm")
    if spec and spec.origin:  # the program itself: the one on the PATH starts a Python first
        program = Path(spec.origin).parent.parent / "bin" / "lcm-gen"
        if os.access(program, os.X_OK):
            return str(program)
    import shutil

    program_on_path = shutil.which("lcm-gen")
    if program_on_path is None:
        raise MissingExtra("lcm-gen is not installed", "type: pip install lcm")
    return program_on_path


def run_lcm_gen(file: Path, options: Sequence[str]) -> Problem | None:
    """Run lcm-gen on one file; return what is wrong with the file, None for nothing.

    Raises:
        MissingExtra: There is no lcm-gen.
    """
    import subprocess

    command = [find_lcm_gen(), *options, str(file)]
    try:
        done = subprocess.run(  # noqa: S603 - lcm-gen, with paths as arguments
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=_LONGEST,
            text=True,
            errors="replace",
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError, ValueError) as error:
        return Problem(str(file), 0, f"lcm-gen cannot read this: {error}")
    return _problem(file, done.stdout) if done.returncode else None


def _problem(file: Path, output: str) -> Problem:
    """The form of lcm-gen's errors: a sentence, ``FILE : LINE``, and the line itself."""
    said = [line.strip() for line in output.splitlines() if line.strip()]
    for before, line in pairwise(said):
        if place := re.fullmatch(rf"{re.escape(str(file))} : (\d+)", line):
            reason = before.rstrip(".")
            return Problem(str(file), int(place[1]), reason, _hint(before))
    return Problem(str(file), 0, said[0] if said else "lcm-gen refuses it and does not say why")


def _hint(reason: str) -> str:
    known = (hint for start, hint in _HINTS.items() if reason.lower().startswith(start))
    return next(known, "")
