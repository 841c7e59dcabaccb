"""The graphics of a terminal, and textual-image's renderables that draw them."""

import os
import re
import select
import sys
import time
from unittest.mock import patch

with patch.object(sys, "__stdout__", None):
    # With a terminal there, the import would send queries and wait for the answers for 0.1 s only:
    # later ones, as over a network, would be taken for keys. ``query`` below waits properly.
    from textual_image._terminal import CellSize, get_cell_size
    from textual_image.renderable import HalfcellImage, SixelImage, TGPImage, UnicodeImage
    from textual_image.renderable._protocol import ImageRenderable

__all__ = ["GRAPHICS", "CellSize", "HalfcellImage", "ImageRenderable", "UnicodeImage", "query"]

GRAPHICS: dict[str, type[ImageRenderable]] = {
    "blocks": HalfcellImage,
    "sixel": SixelImage,
    "kitty": TGPImage,
}
"""By the value of --graphics."""

_KITTY_QUERY, _KITTY_YES = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", b"\x1b_Gi=31;OK"
_CELL_QUERY, _CELL = "\x1b[16t", re.compile(rb"\x1b\[6;(\d+);(\d+)t")
# Primary device attributes, which every terminal answers; 4 among them are sixels (xterm, Control
# Sequences). Sent last: with their answer all others are there.
_ATTRIBUTES_QUERY, _ATTRIBUTES = "\x1b[c", re.compile(rb"\x1b\[\?([0-9;]*)c")
_SIXEL_ATTRIBUTE = b"4"
_TIMEOUT = 0.5  # [s] for the answers, which may come over a network
_USUAL_CELL = CellSize(8, 16)


def query(*, answers: bool) -> tuple[str, CellSize]:
    """Query the terminal at standard input and output for its graphics.

    It must hand over keys one by one; what is typed meanwhile is lost.

    Args:
        answers: False for a terminal that cannot be read from: blocks are for all.

    Returns:
        The best of GRAPHICS that it has, and the size of a character [pixels].
    """
    answer = b""
    if answers:
        sys.stdout.write(f"{_KITTY_QUERY}{_CELL_QUERY}{_ATTRIBUTES_QUERY}")
        sys.stdout.flush()
        answer = _read_answer()
    cell = _cell_size(answer)
    get_cell_size._result = cell  # type: ignore[attr-defined] # noqa: SLF001 - so that it sends no query
    return graphics_in(answer), cell


def graphics_in(answer: bytes) -> str:
    """Return the best graphics that a terminal's answers name."""
    if _KITTY_YES in answer:
        return "kitty"
    attributes = _ATTRIBUTES.search(answer)
    return "sixel" if attributes and _SIXEL_ATTRIBUTE in attributes[1].split(b";") else "blocks"


def _cell_size(answer: bytes) -> CellSize:
    if found := _CELL.search(answer):
        return CellSize(max(1, int(found[2])), max(1, int(found[1])))
    return _USUAL_CELL


def _read_answer() -> bytes:
    deadline = time.monotonic() + _TIMEOUT
    answer = b""
    while not _ATTRIBUTES.search(answer) and (left := deadline - time.monotonic()) > 0:
        if select.select([sys.stdin.fileno()], [], [], left)[0]:
            data = os.read(sys.stdin.fileno(), 4096)
            if not data:
                break
            answer += data
    return answer
