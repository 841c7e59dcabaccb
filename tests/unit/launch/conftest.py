"""Fixtures of the tests of launch files: a text made into a plan."""

from collections.abc import Callable
from pathlib import Path

import pytest

from lcmtools.launch.file import read_file
from lcmtools.launch.plan import Plan
from lcmtools.launch.reading import make_plan


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that launch files are in, and the current one: a workspace of its own."""
    package = tmp_path / "some_package"
    package.mkdir()
    (package / "pyproject.toml").write_text('[project]\nname = "some_package"\n[tool.lcmtools]\n')
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def plan(folder: Path) -> Callable[..., Plan]:
    """``plan(text, robot="husky0")``: the plan of a file a.launch, with arguments."""

    def make(text: str, namespace: str = "/", suffix: str = ".launch", **arguments: str) -> Plan:
        path = folder / f"a{suffix}"
        path.write_text(text)
        environment = {"HOME": "/home/me", "ROBOT": "dolly"}
        return make_plan([read_file(path)], arguments, namespace, environment)

    return make


@pytest.fixture
def xml(plan: Callable[..., Plan]) -> Callable[..., Plan]:
    """``xml(tags)``: the plan of what stands in a ``<launch>``."""

    def make(tags: str, **options: str) -> Plan:
        return plan(f"<launch>\n{tags}\n</launch>", **options)

    return make
