"""The bytes that a process writes, as lines."""

LONGEST = 65_536
"""Bytes; a longer line comes in pieces, so that one that never ends takes no memory."""


class Lines:
    """Takes the output of a process piece by piece; returns the lines."""

    def __init__(self) -> None:
        self._rest = b""

    def take(self, piece: bytes) -> list[str]:
        """Return the lines that are complete now, without their ends."""
        *whole, self._rest = (self._rest + piece).split(b"\n")
        if len(self._rest) > LONGEST:
            whole.append(self._rest)
            self._rest = b""
        return [_text(line) for line in whole]

    def end(self) -> list[str]:
        """Return the rest: a line without an end."""
        rest, self._rest = self._rest, b""
        return [_text(rest)] if rest else []


def _text(line: bytes) -> str:
    return line.removesuffix(b"\r").decode(errors="backslashreplace")
