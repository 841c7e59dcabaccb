"""Colour in terminals: whether it is wanted, and its escape sequences.

The caller passes the environment and the stream; nothing is printed here. Colour is used
sparingly, for faults and their severity.
"""

from collections.abc import Mapping
from typing import TextIO

from lcmtools.errors import LcmtoolsError
from lcmtools.settings import read_user_file

RED = "31"
YELLOW = "33"
BOLD = "1"
BOLD_RED = "1;31"


def is_wanted(environment: Mapping[str, str], usual: str = "auto", *, is_terminal: bool) -> bool:
    """Return True if text for a stream should be coloured.

    LCMTOOLS_COLOR, which ``--color`` sets, takes precedence over NO_COLOR (https://no-color.org),
    FORCE_COLOR and CLICOLOR_FORCE, and these over ``usual``, the user's setting: "auto", "always"
    or "never". With "auto", terminals other than dumb ones get colour.
    """
    chosen = environment.get("LCMTOOLS_COLOR") or "auto"
    if chosen == "auto":
        if environment.get("NO_COLOR"):
            return False
        forced = (environment.get(name, "0") for name in ("FORCE_COLOR", "CLICOLOR_FORCE"))
        chosen = "always" if any(value not in ("", "0") for value in forced) else usual
    if chosen == "auto":
        return is_terminal and environment.get("TERM", "dumb") != "dumb"
    return chosen == "always"


def stream_wants_color(stream: TextIO, environment: Mapping[str, str]) -> bool:
    """Return ``is_wanted`` for a stream and the user's setting."""
    try:
        usual = read_user_file(environment).values.get("color", "auto")
    except LcmtoolsError:  # reported by the code that needs the settings
        usual = "auto"
    try:
        is_terminal = stream.isatty()
    except (AttributeError, ValueError):  # a stream defined by the user, or a closed one
        is_terminal = False
    return is_wanted(environment, usual, is_terminal=is_terminal)


def paint(text: str, color: str) -> str:
    """Return the text in a colour, such as ``RED``."""
    return f"\x1b[{color}m{text}\x1b[0m"
