"""Shared by the labs' tests: lab check of a program, and the processes that are left of a lab."""

import json
import os
import shlex
import sys
from pathlib import Path

import pytest

LONGEST = 25.0
"""Of a check [s], by the simulation's pace; its start and end take less than 5 s more."""


@pytest.fixture
def left_over(tmp_path):
    """Return the command lines of processes with the test's TMPDIR, which it hands to its labs."""

    def find():
        mark = f"TMPDIR={tmp_path}".encode()
        found = []
        for folder in Path("/proc").iterdir():
            try:
                environment = (folder / "environ").read_bytes()
                command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:  # gone already, or somebody else's, or no process at all
                continue
            if mark in environment.split(b"\0") and int(folder.name) != os.getpid():
                found.append(command)
        return [command for command in found if command]

    return find


@pytest.fixture
def check(cli, tmp_path):
    """``check("husky", "controller", source, "fault")``: the rows that are not ok."""

    def run(lab, program, source, fault):
        script = tmp_path / "program.py"
        script.write_text(source)
        command = f"{shlex.join([sys.executable, str(script)])} {fault}"
        result = cli("lab", "check", lab, f"--{program}", command, "--json")
        assert result.code == 1, result.err
        answer = json.loads(result.out)
        assert answer["programs"][program]["duration"] < LONGEST
        return [row for row in answer["rows"] if not row["ok"]]

    return run
