"""Colour for terminals: whether it is wanted, and how it is written.

The caller says what the environment and the stream are; nothing is printed here. Colour is used
sparsely: for what is wrong, and how grave it is.
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
    """Return whether to colour what goes to a stream.

    LCMTOOLS_COLOR counts first (``--color`` sets it), then NO_COLOR (https://no-color.org), then
    FORCE_COLOR and CLICOLOR_FORCE, then what is usual; else a terminal gets colour, unless it is
    a dumb one.

    Args:
        environment: The process's environment variables.
        usual: What the user's settings say: "auto", "always" or "never".
        is_terminal: Whether the stream is a terminal.
    """
    chosen = environment.get("LCMTOOLS_COLOR") or "auto"
    if chosen == "auto" and environment.get("NO_COLOR"):
        return False
    if chosen == "auto" and any(
        environment.get(name, "0") not in ("", "0") for name in ("FORCE_COLOR", "CLICOLOR_FORCE")
    ):
        return True
    if chosen == "auto":
        chosen = usual
    if chosen == "auto":
        return is_terminal and environment.get("TERM", "dumb") != "dumb"
    return chosen == "always"


def stream_wants_color(stream: TextIO, environment: Mapping[str, str]) -> bool:
    """True if to colour what goes to this stream, by the environment and the user's settings."""
    try:
        usual = read_user_file(environment).values.get("color", "auto")
    except LcmtoolsError:  # the code that needs the settings reports it
        usual = "auto"
    return is_wanted(environment, usual, is_terminal=_is_terminal(stream))


def paint(text: str, color: str) -> str:
    """The text in a colour, of which there are names above."""
    return f"\x1b[{color}m{text}\x1b[0m"


def _is_terminal(stream: TextIO) -> bool:
    try:
        return stream.isatty()
    except (AttributeError, ValueError):  # a stream of somebody's own, or a closed one
        return False
