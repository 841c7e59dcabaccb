"""Text in any language and in any locale: as it is for people, UTF-8 for programs."""

import json
import os
import subprocess

import pytest
from fixtures.build import write_log

TEXT = "Hellö 你 \x1b[2J\u202e"
ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
starts = pytest.mark.skipif(
    not __file__.isascii(), reason="in this locale Python cannot read the folder of the sources"
)


@pytest.fixture
def log(tmp_path):
    """A log with one text, on /a."""
    return write_log(tmp_path / "text.lcmlog", (1, "/a", "std_msgs/String", {"data": TEXT}))


@pytest.mark.parametrize(
    "environment",
    [
        pytest.param(ASCII, marks=starts),
        {"PYTHONIOENCODING": "utf-16"},
        {"PYTHONIOENCODING": "ascii:strict"},
    ],
)
def test_a_pipe_gets_utf_8_in_any_locale(environment, log, lcmtools_path):
    def echoed(*options):
        command = [lcmtools_path, "echo", "-b", log, "/a", *options]
        done = subprocess.run(
            command, env=os.environ | environment, stdout=subprocess.PIPE, check=True
        )
        return done.stdout.decode()

    assert json.loads(echoed("--json")) == {"data": TEXT}
    assert echoed() == 'data: "Hellö 你 \\e[2J\\u202E"\n---\n'


@pytest.mark.parametrize(
    ("environment", "shown"),
    [
        ({"LC_ALL": "C.UTF-8"}, 'data: "Hellö 你 \\e[2J\\u202E"'),
        pytest.param(ASCII, 'data: "Hell\\xf6 \\u4f60 \\e[2J\\u202E"', marks=starts),
    ],
)
def test_a_terminal_gets_what_it_can_show(environment, shown, log, on_terminal):
    assert on_terminal("echo", "-b", log, "/a", **environment).splitlines()[0] == shown
