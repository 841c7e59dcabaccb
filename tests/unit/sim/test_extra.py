"""The extra `sim` brings one engine to every Python and system that lcm has wheels for."""

import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

PROJECT = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]
SIM = [Requirement(line) for line in PROJECT["optional-dependencies"]["sim"]]


def engine_with_a_wheel(python, system, machine):
    """The package that has a wheel there, by what `pip download --platform` finds."""
    is_on_intel = machine == "x86_64"
    if system == "linux" and is_on_intel and python in {"3.10", "3.11"}:
        return "pybullet"
    is_old_mac = system == "darwin" and is_on_intel
    return "mujoco" if python == "3.10" or is_old_mac else "mujoco-core"


@pytest.mark.parametrize("python", ["3.10", "3.11", "3.12", "3.13", "3.14"])
@pytest.mark.parametrize(
    ("system", "machine"),
    [("linux", "x86_64"), ("linux", "aarch64"), ("darwin", "arm64"), ("darwin", "x86_64")],
)
def test_each_python_and_system_gets_one_engine_that_has_a_wheel(python, system, machine):
    environment = {
        "python_version": python,
        "sys_platform": system,
        "platform_machine": machine,
    }
    there = {r.name for r in SIM if r.marker is None or r.marker.evaluate(environment)}
    assert there == {"numpy", "pillow", engine_with_a_wheel(python, system, machine)}
