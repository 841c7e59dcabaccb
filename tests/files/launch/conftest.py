"""Fixtures of the tests of launch files: text made into a plan, in a folder with a blank."""

import pytest

from lcmtools.launch.file import read_file
from lcmtools.launch.reading import make_plan


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of the launch files, and the current one."""
    folder = tmp_path / "my robot"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def plan(folder):
    """``plan(text, "a.yaml", robot="husky0")``: the plan of a file, with arguments."""

    def make(text, name="a.launch", **arguments):
        path = folder / name
        path.write_text(text)
        return make_plan([read_file(path)], arguments, "/", {"ROBOT": "dolly"})

    return make
