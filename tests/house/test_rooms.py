"""The house itself: who may import whom, and what a command costs at its start."""

import json
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from lcmtools.cli.lazy import LazyGroup

ROOT = Path(__file__).parents[2]


def test_imports_go_down_only() -> None:
    lint = Path(sysconfig.get_path("scripts")) / "lint-imports"
    done = subprocess.run(
        [lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


HEAVY = {"lcm", "yaml", "numpy", "pybullet", "textual", "rich"}
"""What takes longest to import, or may not even be installed."""

LOOKS = [
    "list",
    "list -v",
    "info /nothing",
    "type /nothing",
    "find std_msgs/String",
    "echo /nothing --timeout 1ms",
    "echo /nothing --filter m.data==1 --timeout 1ms",
    "hz /nothing --timeout 1ms",
    "bw /nothing --timeout 1ms",
    "delay /nothing --timeout 1ms",
    "spy --once --wait 1ms",
    "node list -a",
    "node info /nothing",
    "node ping /nothing",
    "node machine",
    "node cleanup",
    "service list",
    "param list",
    "msg list",
    "msg packages",
    "msg package std_msgs",
    "msg show geometry_msgs/Twist",
    "msg find-field linear",
    "msg fingerprint geometry_msgs/Twist",
    "msg proto geometry_msgs/Twist",
    "srv list",
    "srv show std_srvs/Trigger",
    "config",
    "wtf",
]
"""Commands that only look, also where what they look for is not there."""


def commands() -> list[list[str]]:
    """Every command that there is, by the tables."""
    from lcmtools.cli import main

    tables = {
        group.name: group
        for group in vars(main).values()
        if isinstance(group, LazyGroup) and group is not main.root
    }
    words = [[name] for name in main.root.with_pages()]
    for name, group in tables.items():
        words += [[str(name), verb] for verb in group.with_pages()]
    return words


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


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_no_commands_help_loads_what_is_heavy(words: list[str]) -> None:
    assert not modules_after(*words, "--help") & HEAVY


@pytest.mark.parametrize("line", LOOKS)
def test_who_only_looks_loads_nothing_heavy(
    line: str, bus_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    assert not modules_after(*line.split()) & HEAVY
