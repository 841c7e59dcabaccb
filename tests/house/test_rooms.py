"""The house itself: who may import whom, and what a command costs at its start."""

import json
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_imports_go_down_only() -> None:
    lint = Path(sysconfig.get_path("scripts")) / "lint-imports"
    done = subprocess.run(
        [lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def modules_after(*arguments: str) -> set[str]:
    """The modules that a command has imported when it ends."""
    script = (
        "import json, sys\n"
        "from lcmtools.cli.main import main\n"
        "main(sys.argv[1:])\n"
        "print(json.dumps(sorted(sys.modules)), file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=True
    )
    return set(json.loads(done.stderr.splitlines()[-1]))


@pytest.mark.parametrize(
    "arguments", [["--help"], ["topic", "--help"], ["node", "--help"], ["--version"]]
)
def test_help_loads_neither_the_bus_nor_yaml_nor_types(arguments: list[str]) -> None:
    loaded = modules_after(*arguments)
    heavy = {"lcm", "yaml", "numpy", "pybullet", "lcmtools.bus", "lcmtools.types", "lcmtools.node"}
    assert not loaded & heavy


def test_list_loads_only_what_it_needs() -> None:
    loaded = modules_after("list", "--domain", "99")
    assert "lcmtools.bus.tap" in loaded
    assert not loaded & {"lcm", "yaml", "numpy", "pybullet", "lcmtools.types.sensor_msgs"}
