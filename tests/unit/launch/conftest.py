"""Fixtures of the tests of launch files: a text made into a plan."""

import pytest

from lcmtools.launch.file import read_file
from lcmtools.launch.reading import make_plan


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder that launch files are in, and the current one: a workspace of its own."""
    package = tmp_path / "some_package"
    package.mkdir()
    (package / "pyproject.toml").write_text('[project]\nname = "some_package"\n[tool.lcmtools]\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def plan(folder):
    """``plan(text, robot="husky0")``: the plan of a file a.launch, with arguments."""

    def make(text, namespace="/", suffix=".launch", **arguments):
        path = folder / f"a{suffix}"
        path.write_text(text)
        environment = {"HOME": "/home/me", "ROBOT": "dolly"}
        return make_plan([read_file(path)], arguments, namespace, environment)

    return make


@pytest.fixture
def xml(plan):
    """``xml(tags)``: the plan of what stands in a ``<launch>``."""

    def make(tags, **options):
        return plan(f"<launch>\n{tags}\n</launch>", **options)

    return make
