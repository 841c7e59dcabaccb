"""Escapes for characters that would control a terminal, for text that others have written.

They clear or recolour it, begin a new line or change the direction of the text. Text in any
language is left as it is.
"""

import re

_ODD = (*range(0x7F, 0xA0), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
ESCAPES = {
    code: f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"  # noqa: PLR2004 - two digits
    for code in (*range(0x20), *_ODD)
    if code != ord("\t")
} | {0xDC00 + byte: f"\\x{byte:02x}" for byte in range(0x80, 0x100)}  # bytes that are not UTF-8
"""For ``str.translate`` of one line."""
ESCAPES_IN_LINES = {code: text for code, text in ESCAPES.items() if code != ord("\n")}
"""The same for text of several lines."""
_COLOR = re.compile(r"(\x1b\[[0-9;:]*m)")  # "select graphic rendition" of ECMA-48
_RESET = "\x1b[0m"


def escape_but_colors(line: str) -> str:
    """Return a line of a program's output with all but its colours escaped; they end with it."""
    if line.isprintable():  # the usual case
        return line
    parts = _COLOR.split(line)
    parts[::2] = [part.translate(ESCAPES) for part in parts[::2]]
    is_reset = len(parts) == 1 or parts[-2] in ("\x1b[m", _RESET)
    return "".join(parts) + ("" if is_reset else _RESET)
