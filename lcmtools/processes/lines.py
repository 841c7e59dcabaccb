"""Bytes of a process, as lines.

Belongs here: where a line ends. Must not know processes.
"""

LONGEST = 65_536
"""Bytes; a longer line comes in pieces, so that one that never ends takes no memory."""


class Lines:
    """Takes what a process writes piece by piece; gives the lines."""

    def __init__(self) -> None:
        self._rest = b""

    def take(self, piece: bytes) -> list[str]:
        """The lines that are whole now, without their ends."""
        *whole, self._rest = (self._rest + piece).split(b"\n")
        if len(self._rest) > LONGEST:
            whole.append(self._rest)
            self._rest = b""
        return [_text(line) for line in whole]

    def end(self) -> list[str]:
        """What is left of a line that nothing has ended."""
        rest, self._rest = self._rest, b""
        return [_text(rest)] if rest else []


def _text(line: bytes) -> str:
    return line.removesuffix(b"\r").decode(errors="backslashreplace")
