"""Commands on small logs, as in a terminal: the folder transcripts has what comes back.

``TRANSCRIPTS=write pytest tests/cli/test_transcripts.py`` writes into the files what comes back
now, also for a line ``$ lcmtools ...`` that has just been added; then read what git diff shows.
"""

import os
import re
import shlex
from pathlib import Path

import pytest
from fixtures.logs import write_logs

FILES = sorted((Path(__file__).parent / "transcripts").glob("*.txt"))
_PROMPT = "\n\n$ "
_VARIABLE = re.compile(r"\w+=")


@pytest.fixture
def say(cli, tmp_path, monkeypatch):
    """``say("lcmtools list -b fleet.lcmlog")``: what a terminal would show."""
    write_logs(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LCM_DEFAULT_URL", "memq://")  # in case that -b is forgotten
    monkeypatch.setenv("LC_ALL", "C.UTF-8")

    def run(typed):
        out, errors = "", ""
        for command in typed.split(" | "):
            words, environment = shlex.split(command), {}
            while _VARIABLE.match(words[0]):
                name, _, environment[name] = words.pop(0).partition("=")
            result = cli(*words[1:], input=out, env=environment)
            out, errors = result.out, errors + result.err
        said = out + "".join(f"2> {line}\n" for line in errors.splitlines())
        said += f"[{result.code}]\n" if result.code else ""
        return re.sub(r"(?<= )[~/].*/(\w+/\w+\.lcm)", r"TYPES/\1", said)

    return run


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_commands_say_what_the_transcript_says(file, say, subtests):
    head, *rows = file.read_text().removesuffix("\n").split(_PROMPT)
    now = []
    for row in rows:
        typed = row.partition("\n")[0]
        now.append(f"{typed}\n{say(typed)}".removesuffix("\n"))
        if os.environ.get("TRANSCRIPTS") != "write":
            with subtests.test(typed):
                assert now[-1] == row
    if os.environ.get("TRANSCRIPTS") == "write":
        file.write_text(_PROMPT.join([head, *now]) + "\n")
