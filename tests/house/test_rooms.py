"""The house itself: who may import whom, and what a command costs at its start."""

import ast
import json
import re
import subprocess
import sys
import sysconfig
from collections import defaultdict
from graphlib import TopologicalSorter
from importlib.util import find_spec
from pathlib import Path

import grimp
import pytest

from lcmtools.cli.commands import COMMANDS, TOPIC_VERBS
from lcmtools.cli.lazy import LazyGroup

ROOT = Path(__file__).parents[2]


def test_imports_go_down_only():
    lint = Path(sysconfig.get_path("scripts")) / "lint-imports"
    done = subprocess.run(
        [lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


ARCHITECTURE = (ROOT / "ARCHITECTURE.md").read_text()


def _imports():
    """The packages of lcmtools that each of them imports directly."""
    graph = grimp.build_graph("lcmtools")
    rooms = {path.parent.name for path in (ROOT / "lcmtools").glob("*/__init__.py")}
    found = defaultdict(set)
    for module in graph.modules:
        room = module.split(".")[1] if "." in module else ""
        for imported in graph.find_modules_directly_imported_by(module):
            other = imported.split(".")[1] if "." in imported else ""
            if {room, other} <= rooms and room != other:
                found[room].add(other)
    return found


def test_the_picture_of_the_imports_is_true():
    imports = _imports()

    def reached(room):
        return imports[room].union(*(reached(other) for other in tuple(imports[room])))

    needed = {
        (room, other)
        for room, others in tuple(imports.items())
        for other in others
        if not any(other in reached(between) for between in others - {other})
    }
    assert set(re.findall(r"^    (\w+) --> (\w+)$", ARCHITECTURE, re.MULTILINE)) == needed


LAZY = {  # imported when they are needed, by a module that they use themselves
    ("lcmtools.packages", "lcmtools.packages.user_types"),
}


def test_no_import_goes_in_a_circle():
    graph = grimp.build_graph("lcmtools")
    imports = {
        (module, other)
        for module in graph.modules - {"lcmtools"}  # which has the public names, imported lazily
        if not module.startswith("lcmtools.types.")  # lcm-gen's
        for other in graph.find_modules_directly_imported_by(module) - {"lcmtools"}
    }
    assert imports >= LAZY
    sorter = TopologicalSorter[str]()
    for module, other in imports - LAZY:
        sorter.add(module, other)
    sorter.prepare()  # its error names a circle


def test_every_module_that_this_file_names_is_there():
    named = set(re.findall(r'"(lcmtools(?:\.\w+)+)"', Path(__file__).read_text()))
    assert {name for name in named if find_spec(name) is None} == set()
    assert len(named) > len(LAZY)


def test_every_module_that_the_architecture_names_is_there():
    rooms = "|".join(path.parent.name for path in (ROOT / "lcmtools").glob("*/__init__.py"))
    named = re.findall(rf"`((?:{rooms})(?:/\w+)+)`", ARCHITECTURE)
    missing = [
        name
        for name in named
        if not (ROOT / "lcmtools" / f"{name}.py").exists()
        and not (ROOT / "lcmtools" / name).is_dir()
    ]
    assert (len(named) > 20, missing) == (True, [])


LINUX_ONLY = {
    "bus/network_watch.py",
    *("bus/kernel.py", "bus/processes.py", "processes/reaper.py"),
    "doctor/host.py",
}


def test_files_of_linux_are_read_in_the_modules_that_have_a_fallback():
    readers = {
        path.relative_to(ROOT).as_posix().removeprefix("lcmtools/")
        for folder in ("lcmtools", "sim")
        for path in (ROOT / folder).rglob("*.py")
        if re.search(r"""f?["']/(proc|sys)\b""", path.read_text())
    }
    assert readers == LINUX_ONLY


def test_no_topic_verb_has_the_name_of_another_command():
    hidden = [name for name, entry in TOPIC_VERBS.items() if COMMANDS[name] != entry]
    assert not hidden, f"lcmtools topic {hidden[0]} is not lcmtools {hidden[0]}: rename the verb"


HEAVY = {"lcm", "yaml", "numpy", "pybullet", "textual", "rich"}
"""The slowest modules, and those that may not be installed."""

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


def commands():
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


def newly_loaded(*lines):
    """The modules that each command has imported when it ends, without those of earlier ones."""
    script = (
        "import json, shlex, sys\n"
        "from lcmtools.cli.main import main\n"
        "known, found = set(), {}\n"
        "for line in sys.argv[1:]:\n"
        "    main(shlex.split(line))\n"
        "    found[line] = sorted(set(sys.modules) - known)\n"
        "    known |= set(sys.modules)\n"
        "print(json.dumps(found), file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *lines], capture_output=True, text=True, check=True
    )
    found = json.loads(done.stderr.splitlines()[-1])
    assert list(found) == list(lines)
    return {line: set(modules) for line, modules in found.items()}


def test_help_loads_neither_the_bus_nor_yaml_nor_types():
    loaded = newly_loaded("--help", "topic --help", "node --help", "--version")
    others = {"lcmtools.bus", "lcmtools.types", "lcmtools.node"}
    too_many = {line: names & (HEAVY | others) for line, names in loaded.items()}
    assert {line: names for line, names in too_many.items() if names} == {}


def test_list_loads_only_what_it_needs():
    (loaded,) = newly_loaded("list --domain 99").values()
    assert "lcmtools.bus.tap" in loaded
    assert not loaded & {"lcm", "yaml", "numpy", "pybullet", "lcmtools.types.sensor_msgs"}


@pytest.mark.parametrize(
    ("line", "unneeded"),
    [
        ("--help", "lcmtools.messages.type_source"),
        ("--help", "lcmtools.ros_words"),
        ("list --domain 99", "hashlib"),
        ("lab list", "importlib.metadata"),
        ("msg show geometry_msgs/Twist", "importlib.metadata"),
        ("msg show geometry_msgs/Twist", "lcmtools.packages.ros_files"),
        ("node list --domain 99", "hashlib"),
        ("node list --domain 99", "lcmtools.observe.reports.node_report"),
        ("run --list", "lcmtools.node"),
    ],
)
def test_a_command_leaves_out_what_only_others_need(line, unneeded):
    (loaded,) = newly_loaded(line).values()
    assert unneeded not in loaded


def test_no_commands_help_loads_what_is_heavy():
    loaded = newly_loaded(*(" ".join([*words, "--help"]) for words in commands()))
    assert {line: names & HEAVY for line, names in loaded.items() if names & HEAVY} == {}


def test_who_only_looks_loads_nothing_heavy(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    loaded = newly_loaded(*LOOKS)
    assert {line: names & HEAVY for line, names in loaded.items() if names & HEAVY} == {}


COMMAND_FILES = [
    path for path in (ROOT / "lcmtools").rglob("*.py") if "\n@subcommand(" in path.read_text()
]


@pytest.mark.parametrize("path", COMMAND_FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_command_file_only_parses_asks_and_prints(path):
    text = path.read_text()
    found = {type(node).__name__ for node in ast.walk(ast.parse(text))}
    assert not found & {"ClassDef", "While"}, "a class or a loop without end belongs elsewhere"
    assert "threading" not in text


def test_standard_output_is_written_in_one_place():
    """A full disk and a reader who has gone are dealt with there; print is ruff's (T201)."""
    writes = re.compile(r"(?:stdout|__stdout__)\.(?:write|buffer)|click\.s?echo\(")
    files = (ROOT / "lcmtools").rglob("*.py")
    found = {
        str(path.relative_to(ROOT / "lcmtools"))
        for path in files
        if writes.search(path.read_text())
    }
    assert found == {"cli/output.py", "cli/main.py", "labs/nodes/picture/screen.py"}


@pytest.mark.parametrize("name", ["bag.open", "observe.messages", "publish.publish"])
def test_a_public_package_is_found_without_an_import_of_its_own(name):
    program = f"import lcmtools; print(lcmtools.{name}.__name__)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip()
