"""What may not reach a terminal as it is, in lines that programs print."""

import pytest

from lcmtools.escapes import escape_but_colors


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("plain", "plain"),
        ("größer\t表", "größer\t表"),
        ("\x1b[31mred\x1b[0m", "\x1b[31mred\x1b[0m"),
        ("\x1b[1;31mred\x1b[m end", "\x1b[1;31mred\x1b[m end"),
        ("\x1b[38:2::1:2:3mnot ended", "\x1b[38:2::1:2:3mnot ended\x1b[0m"),
        ("\x1b[2Jcleared", "\\x1b[2Jcleared"),
        ("\x1b]0;title\x07", "\\x1b]0;title\\x07"),
        ("\x1b]52;c;aGk=\x1b\\", "\\x1b]52;c;aGk=\\x1b\\"),
        ("\x1b[31;", "\\x1b[31;"),
        ("\x1b[?1049h\x1b[32mgreen", "\\x1b[?1049h\x1b[32mgreen\x1b[0m"),
        ("first\rsecond", "first\\x0dsecond"),
        ("\x9b2J", "\\x9b2J"),
        ("right \u202e left", "right \\u202e left"),
        ("nul \0", "nul \\x00"),
        ("\udcff", "\\xff"),
    ],
)
def test_colours_pass_and_all_else_that_controls_is_escaped(line, shown):
    assert escape_but_colors(line) == shown
