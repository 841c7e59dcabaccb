"""When there is colour: by flag, environment and settings, and only on a terminal."""

import io

import pytest

from lcmtools.clock import ManualClock
from lcmtools.color import is_wanted, paint, stream_wants_color
from lcmtools.node.logger import Logger

SCREEN = {"TERM": "xterm-256color"}


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        """Return whether it is one."""
        return True


@pytest.mark.parametrize(
    ("environment", "usual", "on_terminal", "in_pipe"),
    [
        (SCREEN, "auto", True, False),
        ({}, "auto", False, False),  # no TERM: nobody knows what it is
        ({"TERM": "dumb"}, "auto", False, False),
        ({**SCREEN, "NO_COLOR": "1"}, "auto", False, False),
        ({**SCREEN, "NO_COLOR": ""}, "auto", True, False),  # as no-color.org has it
        ({**SCREEN, "NO_COLOR": "0"}, "auto", False, False),  # whatever its value
        ({"FORCE_COLOR": "1"}, "auto", True, True),
        ({"CLICOLOR_FORCE": "1"}, "auto", True, True),
        ({**SCREEN, "FORCE_COLOR": "0"}, "auto", True, False),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, "auto", False, False),
        ({"LCMTOOLS_COLOR": "always", "NO_COLOR": "1"}, "never", True, True),
        ({**SCREEN, "LCMTOOLS_COLOR": "never", "FORCE_COLOR": "1"}, "always", False, False),
        ({**SCREEN, "LCMTOOLS_COLOR": "auto"}, "auto", True, False),
        (SCREEN, "never", False, False),
        (SCREEN, "always", True, True),
        ({**SCREEN, "NO_COLOR": "1"}, "always", False, False),  # the environment before the file
    ],
)
def test_flag_then_environment_then_settings_then_the_terminal_decide(
    environment, usual, *, on_terminal, in_pipe
):
    assert is_wanted(environment, usual, is_terminal=True) is on_terminal
    assert is_wanted(environment, usual, is_terminal=False) is in_pipe


def test_settings_file_is_asked_and_a_broken_one_is_not_told_here(tmp_path):
    file = tmp_path / "lcmtools" / "config.yaml"
    file.parent.mkdir()
    environment = {"XDG_CONFIG_HOME": str(tmp_path)}
    file.write_text("color: always\n")
    assert stream_wants_color(io.StringIO(), environment)
    file.write_text("colour: always, please\n")
    assert not stream_wants_color(io.StringIO(), environment)


def test_paint_ends_the_colour_that_it_begins():
    assert paint("x", "31") == "\x1b[31mx\x1b[0m"


@pytest.mark.parametrize(
    ("level", "color"),
    [("info", ""), ("warning", "\x1b[33m"), ("error", "\x1b[31m"), ("fatal", "\x1b[31m")],
)
def test_log_lines_on_a_terminal_have_the_colours_of_ros(level, color, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    for stream, start in ((Terminal(), color), (io.StringIO(), "")):
        logger = Logger("/n", ManualClock(), lambda _entry: None, stream)
        getattr(logger, level)("x")
        line = stream.getvalue()
        assert line.startswith(f"{start}[")
        assert line.endswith("[/n]: x\x1b[0m\n" if start else "[/n]: x\n")
