"""Which graphics a terminal has: it is asked, and answers or not."""

import os
import re
import select
import shutil
import struct
import sys
import termios
import time
from fcntl import ioctl

from lcmtools.labs.nodes.picture import kitty

AUTO, BLOCKS, SIXEL, KITTY = "auto", "blocks", "sixel", "kitty"
CHOICES = (AUTO, BLOCKS, SIXEL, KITTY)

_ANSWER_TIME = 0.4
"""Longest wait for a terminal's answer [s]: it may be at the other end of a network."""
_ATTRIBUTES = "\x1b[c"
# Primary device attributes, which every terminal answers; 4 among them are sixels (xterm, Control
# Sequences). Asked last: with this answer, all others are there.
_ATTRIBUTES_ANSWER = re.compile(rb"\x1b\[\?([0-9;]*)c")
_SIXEL_ATTRIBUTE = b"4"
_USUAL_CELL = (8, 16)


def ask_graphics() -> str:
    """The best graphics of the terminal at standard input and output.

    It must hand over keys one by one; what is typed meanwhile is lost.
    """
    sys.stdout.write(f"{kitty.QUERY}{_ATTRIBUTES}")
    sys.stdout.flush()
    return graphics_in(_read_answer())


def graphics_in(answer: bytes) -> str:
    """What a terminal's answer says that it has."""
    if kitty.YES in answer:
        return KITTY
    attributes = _ATTRIBUTES_ANSWER.search(answer)
    if attributes and _SIXEL_ATTRIBUTE in attributes[1].split(b";"):
        return SIXEL
    return BLOCKS


def cell_size() -> tuple[int, int]:
    """Width and height of a character [pixels]; usual ones where the terminal does not say."""
    try:
        packed = ioctl(sys.stdout.fileno(), termios.TIOCGWINSZ, bytes(8))
    except OSError:
        return _USUAL_CELL
    lines, columns, width, height = struct.unpack("HHHH", packed)
    if not (lines and columns and width and height):
        return _USUAL_CELL
    return max(1, width // columns), max(1, height // lines)


def screen_size() -> tuple[int, int]:
    """Columns and lines."""
    try:
        size = os.get_terminal_size(sys.stdout.fileno())
    except OSError:
        size = shutil.get_terminal_size()
    return max(1, size.columns), max(1, size.lines)


def _read_answer() -> bytes:
    deadline = time.monotonic() + _ANSWER_TIME
    answer = b""
    while not _ATTRIBUTES_ANSWER.search(answer) and (left := deadline - time.monotonic()) > 0:
        if select.select([sys.stdin.fileno()], [], [], left)[0]:
            data = os.read(sys.stdin.fileno(), 4096)
            if not data:
                break
            answer += data
    return answer
