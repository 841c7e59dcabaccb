"""The faults suite: faults are planted, wtf names them, and its remedies mend them.

Every test has a network of its own, so that no rule needs to be ignored: what is found beside the
planted fault is a false alarm, and so is anything that is found in a healthy system. At its end
pytest prints how many were planted, found and false.

A fault is planted by real processes (``World``) and looked for by ``world.finds(rule, who...)``;
what the finding says is done (``world.obey``), and ``world.is_silent()`` closes the test.
Every look counts: there is no second one.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from lcmtools.bus.quick_probe import QuickProbe
from lcmtools.bus.url import choose_url

_PACKAGES = Path(sysconfig.get_path("purelib"))
_HERE = Path(__file__).parent
_SEVERITIES = ("note", "warning", "error")
_LOOP = """
import math, sys, time, lcm
from lcmtools.types.geometry_msgs import *
from lcmtools.types.nav_msgs import *
from lcmtools.types.rosgraph_msgs import *
from lcmtools.types.sensor_msgs import *
from lcmtools.types.std_msgs import *
bus, number, due = lcm.LCM(), 0, time.monotonic()
while True:
    number += 1
    exec(sys.argv[1])
    if number == 3:
        print("sends", flush=True)
    due += float(sys.argv[2])
    time.sleep(max(0.0, due - time.monotonic()))
"""
_HEARS = """
import sys, lcm
bus = lcm.LCM()
for channel in sys.argv[1:]:
    bus.subscribe(channel, lambda channel, data: None)
print("listens", flush=True)
while True:
    bus.handle()
"""


@dataclass(frozen=True)
class Found:
    """A finding as wtf --json tells it."""

    rule: str
    severity: str
    text: str
    items: Sequence[str]
    remedies: Sequence[str]
    subjects: Sequence[dict[str, Any]]
    values: dict[str, Any]
    facts: Sequence[dict[str, Any]]
    actions: Sequence[dict[str, Any]]

    @property
    def everything(self):
        """Its subjects and values as one text; the words are those of tests/doctor/cases."""
        plain = [{k: v for k, v in one.items() if k != "text"} for one in self.actions]
        return json.dumps([self.subjects, self.values, self.facts, plain], ensure_ascii=False)

    @property
    def kinds(self):
        """The kinds of its remedies."""
        return [one["kind"] for one in self.actions]

    @property
    def variables(self):
        """The variables that the remedies set."""
        return {one["variable"]: one["value"] for one in self.actions if "variable" in one}

    @property
    def commands(self):
        """The commands in the remedies, as root types them."""
        return [word.replace("sudo ", "") for one in self.actions for word in one["commands"]]


class World:
    """A network with processes in it, and wtf."""

    def __init__(self, start, folder, command):
        self._start, self._folder, self.command = start, folder, command
        self._started = {}
        self._programs = {}
        self.planted, self.found, self.looks, self.alarms = 0, 0, 0, 0

    # --- processes -----------------------------------------------------------------------------

    def start(self, *command, **environment):
        """Any process."""
        program = self._start(*command, **environment)
        self._started[program.pid] = command, environment
        self._programs[program.pid] = program
        return program

    def node(self, *arguments, **environment):
        """``lcmtools run ...``, once its node has announced itself."""
        return self.tool("run", *arguments, **environment)

    def tool(self, *arguments, **environment):
        """Any command of lcmtools, once its node has announced itself."""
        program = self.start(self.command, *arguments, **environment)
        self.until(lambda: program.pid in self.pids(**environment))
        return program

    def script(self, source, *arguments, ready="", **environment):
        """A Python program; with ``ready``, once it has printed that."""
        path = self._folder / f"program_{len(self._started)}.py"
        path.write_text(source)
        program = self.start(sys.executable, str(path), *arguments, **environment)
        if ready:
            program.wait_for(ready)
        return program

    def sends(self, statements, period=0.02, **environment):
        """A plain LCM program that does these statements again and again."""
        return self.script(_LOOP, statements, str(period), ready="sends", **environment)

    def hears(self, *channels, **environment):
        """A plain LCM program that listens to channels (patterns)."""
        return self.script(_HEARS, *channels, ready="listens", **environment)

    def lcm(self, name, *arguments, **environment):
        """A program of the lcm package; a listener once it has joined the bus."""
        program = self.start(self.program(name), *arguments, **environment)
        if name != "lcm-source":
            self.until(lambda: self.listens(program))
        return program

    def c(self, name, *arguments, **environment):
        """A C program of this folder, linked with the lcm package's library."""
        compiler = shutil.which("gcc") or pytest.skip("no gcc to compile C programs with")
        program = self._folder / name
        options = [f"-I{_PACKAGES / 'include'}", f"-L{_PACKAGES / 'lib'}"]
        options += [f"-Wl,-rpath,{_PACKAGES / 'lib'}", "-llcm", "-lm"]
        source = _HERE / "programs" / f"{name}.c"
        subprocess.run([compiler, "-o", program, source, *options], check=True)
        started = self.start(str(program), *arguments, **environment)
        started.wait_for("ready")
        return started

    def java(self, name, *arguments, **environment):
        """A Java program of this folder, with the lcm package's lcm.jar."""
        jar = _PACKAGES / "share/java/lcm.jar"
        java, compiler = shutil.which("java"), shutil.which("javac")
        if not java or not compiler or not jar.exists():
            pytest.skip("no Java to run Java programs with")
        source = _HERE / "programs" / f"{name}.java"
        subprocess.run([compiler, "-cp", jar, "-d", self._folder, source], check=True)
        path = f"{jar}{os.pathsep}{self._folder}"
        options = ("-Xshare:auto", "-XX:TieredStopAtLevel=1", "-Djava.net.preferIPv4Stack=true")
        started = self.start(java, *options, "-cp", path, name, *arguments, **environment)
        started.wait_for("ready")
        return started

    def again(self, program, *arguments, without="", replacing=None, **environment):
        """End a program and start it as it was, with these arguments and variables added.

        Of arguments like __ns:=/a it has each once: the new ones replace.
        """
        command, before = self._started[program.pid]
        self.end(program)
        said = {word.partition(":=")[0] for word in arguments if ":=" in word}
        kept = [
            (replacing or {}).get(word, word)
            for word in command
            if word != without and (":=" not in word or word.partition(":=")[0] not in said)
        ]
        renewed = {**before, **environment}
        program = self.start(*kept, *arguments, **renewed)
        if command[0] == self.command:
            self.until(lambda: program.pid in self.pids(**renewed))
        elif not command[0].endswith("lcm-source"):
            self.until(lambda: program.lines or self.listens(program))
        return program

    def obey(self, found, *kinds):
        """Do what the remedies of these kinds say (else all): start programs otherwise, type."""
        pids = [one["pid"] for one in found.subjects if one["pid"] in self._programs]
        nodes = {}
        for action in found.actions:
            if action["kind"] in kinds or not kinds:
                if "node" in action and _change(action):
                    nodes[(action["node"], *_change(action))] = None
                else:
                    self._do(action, list(dict.fromkeys(pids)))
        for name, added, without in nodes:
            self.again(self.of_node(name), *filter(None, [added]), without=without)

    def _do(self, action, pids):
        kind = action["kind"]
        if kind == "republish":
            words = {action["channel"]: action["topic"]}
            self.again(self.of_node(action["publisher"]), replacing=words)
        elif kind == "end-or-rename":
            self.again(self._programs[pids[-1]], f"__name:={action['name']}")
        elif "variable" in action or kind == "restart-listeners":
            variables = {action["variable"]: action["value"]} if "variable" in action else {}
            for pid in pids:
                self.again(self._programs[pid], **variables)
        elif action["commands"]:  # others in it are further ways
            self.type(action["commands"][0].replace("sudo ", ""))

    def program(self, name):
        """The path of a program of the lcm package."""
        return str(_PACKAGES / "bin" / name)

    def fingerprint(self, definition):
        """The fingerprint that lcm-gen gives a type's definition, as hexadecimal digits."""
        file = self._folder / "type.lcm"
        file.write_text(definition)
        command = [self.program("lcm-gen"), "--python", "--ppath", self._folder, file]
        subprocess.run(command, check=True, capture_output=True)
        package, name = re.findall(r"(?:package|struct) (\w+)", definition)
        text = f"from {package} import {name}; print({name}._get_packed_fingerprint().hex())"
        command = [sys.executable, "-c", text]
        done = subprocess.run(command, cwd=self._folder, check=True, capture_output=True, text=True)
        return done.stdout.strip()

    def is_heard_by(self, user):
        """Return whether a program of this user listens to the usual bus."""
        rows = Path("/proc/thread-self/net/udp").read_text().splitlines()[1:]
        return any(row.split()[7] == str(user) and row.split()[1].endswith(":1DF3") for row in rows)

    def node_of(self, program):
        """The node of a program, as it is announced."""
        found = []

        def is_there():
            found[:] = [one for one in self.graph().nodes if one.pid == program.pid]
            return found

        self.until(is_there)  # on a busy computer an answer may be late
        (node,) = found
        return node

    def of_node(self, name, **environment):
        """The program of a node."""
        found = []

        def is_there():
            nodes = self.graph(**environment).named(name)
            found[:] = [self._programs[one.pid] for one in nodes if one.pid in self._programs]
            return found

        self.until(is_there)  # on a busy computer an answer may be late
        (program,) = found
        return program

    def end(self, program):
        """End a program as Ctrl-C does, or as kill does what minds no Ctrl-C."""
        program.send_signal(2)
        try:
            program._process.wait(10)
        except subprocess.TimeoutExpired:
            program.send_signal(15)
            program.wait()

    def type(self, command, **environment):
        """Type a command into a shell, as it stands; its output."""
        words = {"lcmtools": self.command}
        first, _, rest = command.partition(" ")
        if command.startswith("lcmtools run "):  # goes on running
            self.node(*rest.split()[1:], **environment)
            return ""
        result = subprocess.run(
            ["/bin/sh", "-c", f"{words.get(first, first)} {rest}"],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=40,
            check=False,
        )
        assert result.returncode == 0, f"{command}: {result.stderr}"
        return result.stdout

    # --- what there is ---------------------------------------------------------------------------

    def graph(self, **environment):
        """The packets on a bus."""
        url, _ = choose_url("", "", {**os.environ, **environment})
        with QuickProbe(url) as glance:
            return glance.graph()

    def pids(self, **environment):
        """The processes of the nodes on a bus."""
        return {node.pid for node in self.graph(**environment).nodes}

    def listens(self, program):
        """Return whether a program listens to a multicast group."""
        rows = Path(f"/proc/{program.pid}/net/udp").read_text().splitlines()[1:]
        held = set()
        for file in Path(f"/proc/{program.pid}/fd").iterdir():
            with suppress(OSError):  # closed meanwhile
                held.add(str(file.readlink()))
        mine = [row.split() for row in rows if f"socket:[{row.split()[9]}]" in held]
        return any(row[1].split(":")[0].endswith("EF") or row[1].endswith(":1DF3") for row in mine)

    def until(self, condition, timeout=40.0):
        """Wait for something; fails the test where it does not come."""
        deadline = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < deadline, f"not within {timeout} s"
            time.sleep(0.01)

    # --- wtf -------------------------------------------------------------------------------------

    def look(self, *arguments, wait="0.5s", **environment):
        """The findings of wtf, all rules; checks that the exit code goes with it."""
        result = subprocess.run(
            [self.command, "wtf", "--json", "--wait", wait, *arguments],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert result.stderr == ""
        # what only root could look at is no finding
        records = [one for one in json.loads(result.stdout) if one["severity"] != "unchecked"]
        found = [Found(**record) for record in records]
        worst = max((_SEVERITIES.index(one.severity) for one in found), default=0)
        assert result.returncode == worst
        return found

    def finds(self, rule, *who, **options):
        """Let wtf name this fault, with all of ``who`` in it, and nothing else."""
        self.planted += 1
        texts = [str(text) for text in who]
        found = self.look(**options)
        self.alarms += sum(one.rule != rule for one in found)
        named = [one for one in found if one.rule == rule]
        missing = _missing(named, texts)
        self.found += bool(named) and not missing
        assert [one.rule for one in found] == [rule], _told(found)
        assert not missing, f"{missing} are not in:\n{_told(found)}"
        return named[0]

    def is_silent(self, **options):
        """Let wtf find nothing at all."""
        self.looks += 1
        found = self.look(**options)
        self.alarms += len(found)
        assert found == [], _told(found)


def _change(action):
    """The argument that a node is to have, and the one that it is not to have any more."""
    kind, without = action["kind"], action.get("argument", "")
    added = f"__ns:={action['namespace']}" if kind == "namespace" else ""
    added = f"{action['old']}:={action['new']}" if "old" in action else added
    return (added, without) if added or kind == "drop-remap" else ()


def _missing(found, texts):
    everything = "\n".join(one.everything for one in found)
    return [text for text in texts if text not in everything]


def _told(found):
    return "\n".join(f"{one.rule} ({one.severity}): {one.everything}" for one in found) or "nothing"


@pytest.fixture
def world(
    private_network,  # noqa: ARG001 - it is there while the world is
    start,
    tmp_path,
    lcmtools_path,
    record_property,
):
    """A network of the test's own, with nothing in it yet."""
    made = World(start, tmp_path, lcmtools_path)
    yield made
    record_property("faults", [made.planted, made.found, made.looks, made.alarms])
