"""Keys in the bytes that a terminal sends: characters and arrows.

Pure text processing. What a key means is not known here.
"""

import re

UP, DOWN, LEFT, RIGHT = "up", "down", "left", "right"
ESCAPE = "escape"
END_OF_INPUT = "end"
"""Ctrl-D, which a terminal that hands over single keys passes on as a character."""

_ARROWS = {"A": UP, "B": DOWN, "C": RIGHT, "D": LEFT}
_CONTROLS = {"\x04": END_OF_INPUT, "\x1b": ESCAPE}
# ECMA-48: ESC [ parameters, intermediates, a final character; ESC O and a letter is what keypads
# send (xterm, Control Sequences, "SS3"); ESC [ M and three bytes is an old kind of mouse report.
_SEQUENCE = re.compile(
    r"\x1b\[M...|\x1b\[[0-?]*[ -/]*(?P<last>[@-~])|\x1bO(?P<pad>.)|\x1b(?P<alt>[^\x1b\[O])|.",
    re.DOTALL,
)
_UNFINISHED = re.compile(r"\x1b(\[M.{0,2}|\[[0-?]*[ -/]*|O)?\Z", re.DOTALL)


def split_keys(data: bytes, *, is_complete: bool) -> tuple[list[str], bytes]:
    """The keys in what a terminal has sent: characters, and the names above.

    Escape sequences other than the arrows' (function keys, mouse, focus) are left out; what is
    typed with Alt counts as the character alone.

    Args:
        data: The bytes so far.
        is_complete: No more belongs to them: an escape character at the end is the Escape key.

    Returns:
        The keys, and the bytes that are the beginning of another one.
    """
    text = data.decode("utf-8", "surrogateescape")
    rest = "" if is_complete else _unfinished(text)
    found = (_key(match) for match in _SEQUENCE.finditer(text.removesuffix(rest)))
    return [key for key in found if key], rest.encode("utf-8", "surrogateescape")


def _unfinished(text: str) -> str:
    match = _UNFINISHED.search(text)
    return match.group() if match else ""


def _key(match: re.Match[str]) -> str:
    """One key's name; "" for a sequence that is none."""
    text = match.group()
    if len(text) == 1:
        return _CONTROLS.get(text, text)
    if match["alt"]:
        return match["alt"]
    return _ARROWS.get(match["last"] or match["pad"] or "", "")
