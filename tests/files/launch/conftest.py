"""Fixtures of the tests of launch files: text made into a plan, in a folder with a blank."""

from collections.abc import Callable
from pathlib import Path

import pytest

from lcmtools.launch.file import read_file
from lcmtools.launch.plan import Plan
from lcmtools.launch.reading import make_plan


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the launch files, and the current one."""
    folder = tmp_path / "my robot"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def plan(folder: Path) -> Callable[..., Plan]:
    """``plan(text, "a.yaml", robot="husky0")``: the plan of a file, with arguments."""

    def make(text: str, name: str = "a.launch", **arguments: str) -> Plan:
        path = folder / name
        path.write_text(text)
        return make_plan([read_file(path)], arguments, "/", {"ROBOT": "dolly"})

    return make
