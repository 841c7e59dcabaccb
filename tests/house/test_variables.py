"""The environment variables that are read are those of the tables in lcmtools.settings."""

import ast
import re
from pathlib import Path

from lcmtools.settings import SETTINGS, VARIABLES

ROOT = Path(__file__).parents[2]

OF_THE_SYSTEM = {
    *("COLORTERM", "COLUMNS", "DISPLAY", "HOME", "LANG", "LC_ALL", "LC_CTYPE", "LINES", "PATH"),
    *("PYTHONPATH", "PYTHONUNBUFFERED", "SHELL", "TERM", "WAYLAND_DISPLAY", "XDG_CACHE_HOME"),
    *("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR", "XDG_STATE_HOME", "ZDOTDIR"),
}
BETWEEN_PROCESSES = {"LCMTOOLS_GUARD", "LCMTOOLS_LOCKSTEP", "_LCMTOOLS_COMPLETE"}
OTHER_NAMES = {"LCM_SELF_TEST", "CATKIN_IGNORE", "SC_CLK_TCK", "SC_PAGE_SIZE"}
"""Not variables: a channel, a file, values of sysconf."""
_NAME = re.compile(r"_?[A-Z][A-Z0-9]*(_[A-Z0-9]+)+|[A-Z]+")


def read_names():
    """Texts that look like variables' names, in modules that know of an environment.

    A single word counts only where it is looked up in one.
    """
    for folder in ("lcmtools", "sim"):
        for file in (ROOT / folder).rglob("*.py"):
            text = file.read_text()
            if "environ" not in text or file.name == "settings.py":
                continue
            for node in ast.walk(ast.parse(text)):
                if isinstance(node, ast.Constant) and _NAME.fullmatch(str(node.value)):
                    name = str(node.value)
                    if "_" in name or re.search(rf'environ\w*(\.get\(|\[)"{name}"', text):
                        yield name


def test_variables_that_are_read_are_in_the_table():
    known = {one.variable for one in SETTINGS.values()} | VARIABLES.keys()
    found = set(read_names()) - OF_THE_SYSTEM - BETWEEN_PROCESSES - OTHER_NAMES
    assert found - known == set()
    looked_up_by_a_setting = {"LCMTOOLS_TIMEOUT"}
    assert known - found == looked_up_by_a_setting
