"""Every command block of the README, docs/ and labs/ does what it shows.

A block that begins with ```sh has commands as they are typed, a line each, to be pasted. One that
begins with ```console has commands behind "$ " and, below each, what it prints: every line shown
must come, in this order; … stands for anything within a line, and alone for any lines. A command
that goes on is ended with Ctrl-C once what is shown has come; one that ends with & runs until the
block is over. An exit code other than 0 is as it should be where output is shown. Comments before a
block say more:

    <!-- with: run sim --world husky; run talker -->   what runs beside it, without "lcmtools"
    <!-- not run: it needs a second computer -->       why not
    <!-- file: slow.py -->                             the block is this file, in the scratch folder
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from lcmtools.bus.url import parse_url
from lcmtools.cli import main
from lcmtools.observe.reading.monitor import BusMonitor

ROOT = Path(__file__).parents[2]
DOCUMENTS = [
    ROOT / "README.md",
    *sorted(ROOT.glob("docs/*.md")),
    *sorted(ROOT.glob("labs/*/README.md")),
]
_FENCE = re.compile(r"((?:^[ ]*<!--.*?-->\n+)*)^```(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NOTE = re.compile(r"<!-- (with|not run|file): (.*?) -->")
_INLINE = re.compile(r"`lcmtools ([a-z][a-z-]*)(?: ([a-z][a-z-]*))?")
LANGUAGES = {"sh", "console", "python", "yaml", "xml", "text", "c", "cpp"}
GOING_ON = 2.5  # [s] after which a command that still runs and shows nothing is meant to go on
ENDING = 0.3  # [s] in which a command that has shown all comes to its end
LONGEST = 120.0


@dataclass
class Command:
    """A command and what is shown below it."""

    text: str
    shown: list[str] = field(default_factory=list)


@dataclass
class Block:
    """A fenced block and the comments before it."""

    line: int
    language: str
    text: str
    notes: dict[str, str]

    def commands(self):
        """The lines that are typed in it."""
        found = []
        for line in self.text.splitlines():
            if self.language == "sh":
                found += [Command(line)] if line.strip() else []
            elif line.startswith("$ "):
                found.append(Command(line[2:]))
            elif line.strip():
                found[-1].shown.append(line)
        return found


def blocks(document):
    """The fenced blocks of a document."""
    text = document.read_text()
    return [
        Block(
            text[: match.start()].count("\n") + 1, match[2], match[3], dict(_NOTE.findall(match[1]))
        )
        for match in _FENCE.finditer(text)
    ]


class Shell:
    """Runs commands in a folder, on a bus."""

    def __init__(self, folder, bus_url, lcmtools_path):
        self._folder = folder
        self._environment = {
            **os.environ,
            "LCM_DEFAULT_URL": bus_url,
            "PATH": os.pathsep.join(
                (
                    str(Path(lcmtools_path).parent),
                    str(Path(sys.executable).parent),
                    os.environ["PATH"],
                )
            ),
            "XDG_STATE_HOME": str(folder / ".state"),
            "PYTHONUNBUFFERED": "1",
            "NO_COLOR": "1",
            "COLUMNS": "100",
        }
        self._outputs = 0

    @contextmanager
    def going(self, command):
        """A command in the background, ended with Ctrl-C and then by force."""
        self._outputs += 1
        running = Running(command, self._folder, self._environment, f".output_{self._outputs}")
        try:
            yield running
        finally:
            running.end()

    def run(self, command):
        """Run a command as a reader would; what is wrong with it, or None."""
        with self.going(command.text) as running:
            began = time.monotonic()
            told = any(line.strip() != "…" for line in command.shown)
            while running.code() is None and time.monotonic() - began < LONGEST:
                if shows(running.output(), command.shown) and (
                    told or time.monotonic() - began > GOING_ON
                ):
                    running.wait(ENDING)
                    break
                time.sleep(0.05)
            goes_on = running.code() is None
            running.end()
            output, code = running.output(), running.code()
        if not shows(output, command.shown):
            return f"$ {command.text}\nprinted:\n{output}\ninstead of:\n" + "\n".join(command.shown)
        if code not in (0, *((130, -signal.SIGINT) if goes_on else ())) and not told:
            return f"$ {command.text}\nended with {code}:\n{output}"
        return None

    def wait_for(self, commands):
        """Wait until commands that run beside a block are on the bus: nodes, or other programs."""
        nodes = sum(command.startswith("lcmtools ") for command in commands)
        deadline = time.monotonic() + 60
        with BusMonitor(
            parse_url(self._environment["LCM_DEFAULT_URL"]), "test", os.environ
        ) as watch:
            while time.monotonic() < deadline:
                named = [node for node in watch.settle(foreign=False).nodes if not node.stale]
                others = self._others() if len(commands) > nodes else 0
                if len(named) >= nodes and len(named) + others >= len(commands):
                    return
                time.sleep(0.1)
        pytest.fail(f"{', '.join(commands)}: not all run")

    def _others(self):
        """The number of programs that use LCM and are no nodes."""
        listed = subprocess.run(
            ["lcmtools", "node", "list", "-a", "--json"],  # noqa: S607 - as documents have it
            env=self._environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
        return [record["node"] for record in json.loads(listed.stdout or "[]")].count(None)


class Running:
    """A command that runs."""

    def __init__(self, command, folder, environment, output):
        self._output = folder / output
        with self._output.open("wb") as stream:
            self._process = subprocess.Popen(
                ["bash", "-c", f"trap - INT; {command}"],  # noqa: S607
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def code(self):
        """Its exit code; None while it runs."""
        return self._process.poll()

    def wait(self, timeout):
        """Wait for its end, for so many seconds at most."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout)

    def output(self):
        """Its output."""
        return self._output.read_text(errors="replace")

    def end(self):
        """End it, and whatever it has left in the background, which does not hear Ctrl-C."""
        for number in (signal.SIGINT, signal.SIGTERM):
            if self.code() is not None:
                break
            os.killpg(self._process.pid, number)
            deadline = time.monotonic() + 20
            while self.code() is None and time.monotonic() < deadline:
                time.sleep(0.02)
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


def shows(output, shown):
    """Return whether the lines shown are in an output, in their order; … is anything."""
    rest = [line.rstrip() for line in output.splitlines()]
    for line in shown:
        pattern = ".*".join(re.escape(part) for part in re.split(r"…", line.rstrip()))
        places = [at for at, text in enumerate(rest) if re.fullmatch(pattern, text)]
        if line.strip() == "…":
            continue
        if not places:
            return False
        rest = rest[places[0] + 1 :]
    return True


@pytest.mark.usefixtures("quiet_network")
@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_block_does_what_it_shows(document, tmp_path, bus_url, lcmtools_path):
    has_compiler = shutil.which("g++")
    if document.name == "cpp.md" and not has_compiler:
        pytest.skip("no g++ to compile C++ programs with")
    wrong = []
    with ExitStack() as stack:
        beside = Beside(Shell(tmp_path, bus_url, lcmtools_path), stack)
        for block in blocks(document):
            where = f"{document.relative_to(ROOT)}:{block.line}"
            if "file" in block.notes:
                (tmp_path / block.notes["file"]).write_text(block.text)
            is_left_out = "not run" in block.notes or ("$ g++" in block.text and not has_compiler)
            if block.language in ("sh", "console") and not is_left_out:
                wrong += [f"{where}\n{problem}" for problem in play(block, beside)]
    assert wrong == [], "\n\n".join(wrong)


class Beside:
    """The commands that run beside a document's blocks, for as long as the next one wants them too.

    Args:
        shell: Runs them.
        stack: Ends them with the document.
    """

    def __init__(self, shell, stack):
        self.shell = shell
        self._stack = stack
        self._running = {}

    def be(self, commands):
        """Let these run and no others."""
        for command, running in list(self._running.items()):
            if command not in commands or running.code() is not None:
                self._running.pop(command).end()
        for command in commands:
            if command not in self._running:
                going = self.shell.going(f"exec {command}")
                self._running[command] = self._stack.enter_context(going)
        if commands:
            self.shell.wait_for(commands)

    def commands(self):
        """Those that run."""
        return list(self._running)


def play(block, beside):
    """Run a block; what is wrong."""
    wrong = []
    parts = block.notes.get("with", "").split(";")
    beside.be([f"lcmtools {part.strip()}" for part in parts if part.strip()])
    for command in block.commands():
        if command.text.endswith("&"):
            beside.be([*beside.commands(), command.text[:-1].strip()])
        elif problem := beside.shell.run(command):
            wrong.append(problem)
    return wrong


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_block_says_what_it_is(document):
    unknown = [
        f"{document.relative_to(ROOT)}:{block.line}: '{block.language}'"
        for block in blocks(document)
        if block.language not in LANGUAGES and "not run" not in block.notes
    ]
    assert unknown == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_block_can_be_pasted(document):
    for block in blocks(document):
        where = f"{document.relative_to(ROOT)}:{block.line}"
        assert not re.search("^> ", block.text, re.MULTILINE), f"{where}: a prompt in a command"
        if block.language == "console":
            shown = [command for command in block.commands() if command.shown]
            assert shown, f"{where}: shows no output: make it sh, without prompts"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_command_that_is_named_exists(document):
    unknown = []
    for name, verb in _INLINE.findall(document.read_text()):
        command = main.root.get_command(None, name)
        verbs = getattr(command, "list_commands", None)
        if command is None or (verb and verbs and verb not in verbs(None)):
            unknown.append(f"lcmtools {name} {verb}")
    assert unknown == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_within_the_project_leads_somewhere(document):
    text = _FENCE.sub("", document.read_text())  # a lambda in C++ looks like a link
    links = re.findall(r"\]\((?!https?:)([^)#]*)#?([^)]*)", text)
    assert [link for link in links if not leads_somewhere(document, *link)] == []


def leads_somewhere(document, page, anchor):
    """Return whether a page is there, with a heading that makes the anchor as GitHub does."""
    target = document.parent / page if page else document
    if not anchor or not target.exists():
        return target.exists()
    headings = re.findall("^#+ (.+)$", target.read_text(), re.MULTILINE)
    return anchor in [re.sub(r"[^\w -]", "", one).lower().replace(" ", "-") for one in headings]


@pytest.mark.parametrize("page", sorted(ROOT.glob("labs/*/README.md")), ids=str)
def test_a_lab_s_page_has_the_picture_of_its_robot_and_says_where_cpp_stands(page):
    text = page.read_text()
    assert f"(../../docs/{page.parent.name}.png)" in text.partition("## 1.")[0]
    assert "C++" in text
    assert (ROOT / "examples" / "plain_lcm").is_dir()
