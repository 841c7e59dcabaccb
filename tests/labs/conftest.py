"""Shared by the labs' tests: the processes that are left of a lab."""

import os
from pathlib import Path

import pytest


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
