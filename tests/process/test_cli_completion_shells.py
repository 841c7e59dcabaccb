"""TAB in real shells, in a terminal: what stands on the line afterwards.

A shell or tmux that is not installed skips its tests.
"""

import os
import shlex
import shutil
import subprocess
import uuid
from pathlib import Path

import pytest

from lcmtools.cli.completion.install import install, plan

SHELLS = ("bash", "zsh", "fish")
PROMPT = "READY> "
_START = {
    "bash": ["bash", "--noprofile", "-i"],
    "zsh": ["zsh", "-d", "-i"],
    "fish": ["fish", "-i"],
}
_FISH = f"""
set fish_greeting
set fish_autosuggestion_enabled 0
function fish_prompt; printf '{PROMPT}'; end
"""
_SETTINGS = {
    "bash": (".bashrc", f"PS1='{PROMPT}'\nbind 'set bell-style none'\n"),
    "zsh": (".zshrc", f"PS1='{PROMPT}'\nunsetopt prompt_sp\n"),
    "fish": (
        ".config/fish/config.fish",
        _FISH,
    ),
}


class Terminal:
    """A shell in a terminal of its own."""

    def __init__(self, shell, home, environment):
        self._tmux = ["tmux", "-L", f"lcmtools-{uuid.uuid4().hex}"]
        said = [f"{name}={value}" for name, value in environment.items()]
        command = shlex.join(["env", "-u", "PROMPT_COMMAND", *said, *_START[shell]])
        self._run(
            "-f",
            "/dev/null",
            "new-session",
            "-d",
            "-x",
            "200",
            "-y",
            "50",
            "-c",
            str(home),
            command,
        )

    def type(self, *keys):
        """Press keys: texts, or names like Tab."""
        for key in keys:
            self._run("send-keys", *([] if key in ("Tab", "Enter", "C-u") else ["-l"]), key)

    def screen(self):
        """The lines on the screen, without empty ones."""
        shown = self._run("capture-pane", "-p", "-J")
        return "\n".join(line.rstrip() for line in shown.splitlines() if line.strip())

    def close(self):
        """End it, and the shell with it."""
        self._run("kill-server")

    def _run(self, *arguments):
        ended = subprocess.run(
            [*self._tmux, *arguments],
            capture_output=True,
            text=True,
            timeout=40,
            check=False,
            env={**os.environ, "SHELL": "/bin/sh"},  # without one tmux takes the user's: nologin
        )
        return ended.stdout


@pytest.fixture(params=SHELLS)
def shell(request):
    """A shell that is installed."""
    name = str(request.param)
    for program in (name, "tmux"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed")
    return name


@pytest.fixture
def terminal(shell, tmp_path, bus_url, lcmtools_path, cli, wait_until):
    """The shell with completion installed, at its prompt."""
    environment = {
        "HOME": str(tmp_path),
        "XDG_DATA_HOME": "",
        "XDG_CONFIG_HOME": "",
        "XDG_RUNTIME_DIR": os.environ["XDG_RUNTIME_DIR"],
        "LCM_DEFAULT_URL": bus_url,
        "PATH": f"{Path(lcmtools_path).parent}:{os.environ['PATH']}",
        "SHELL": f"/bin/{shell}",
        "TERM": "screen",
        "LC_ALL": "C.UTF-8",
    }
    name, text = _SETTINGS[shell]
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).write_text(text)
    assert cli("completion", "--install", env=environment).code == 0
    opened = Terminal(shell, tmp_path, environment)
    try:
        wait_until(lambda: opened.screen().startswith(PROMPT.strip()))
        yield opened
    finally:
        opened.close()


@pytest.fixture
def completes(terminal, wait_until):
    """``completes("lcmtools ec", "lcmtools echo")``: what a TAB makes of what is typed."""

    def press(typed, wanted):
        terminal.type("C-u", typed)
        wait_until(lambda: terminal.screen().endswith(f"{PROMPT}{typed}".rstrip()))
        line = f"{PROMPT}{wanted}".rstrip()
        terminal.type("Tab")
        wait_until(lambda: line in terminal.screen().splitlines())

    return press


@pytest.fixture
def talker(start, lcmtools_path, bus_url):
    """A node on the bus."""
    start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=bus_url).wait_for("hello")


@pytest.mark.usefixtures("talker")
def test_tab_completes_a_command_a_topic_its_type_and_its_prototype(shell, completes, terminal):
    prototype = {"fish": "\\{data:\\ \\'\\'\\}"}.get(shell, "\"{data: ''}\"")
    completes("lcmtools ec", "lcmtools echo")
    completes("lcmtools echo /chat", "lcmtools echo /chatter")
    completes("lcmtools echo /chatter.d", "lcmtools echo /chatter.data")
    completes("lcmtools pub /chatter ", "lcmtools pub /chatter std_msgs/String")
    completes(
        "lcmtools pub /chatter std_msgs/String ",
        f"lcmtools pub /chatter std_msgs/String {prototype}",
    )
    completes(
        'lcmtools pub /chatter std_msgs/String "',
        "lcmtools pub /chatter std_msgs/String \"{data: ''}\"",
    )
    completes("lcmtools run listener chatter:=/chat", "lcmtools run listener chatter:=/chatter")
    completes("lcmtools echo /chatter --field=da", "lcmtools echo /chatter --field=data")
    assert "rror" not in terminal.screen()


def test_tab_completes_names_that_are_always_there(completes, terminal):
    completes("lcmtools lab start hu", "lcmtools lab start husky")
    completes("lcmtools lab skeleton kin", "lcmtools lab skeleton kinect_viewer")
    completes("lcmtools wtf --rule kernel", "lcmtools wtf --rule kernel-drops")
    completes("lcmtools graph --format=me", "lcmtools graph --format=mermaid")
    assert "rror" not in terminal.screen()


@pytest.mark.usefixtures("talker")
def test_the_prototype_reaches_the_command_whole(completes, terminal, shell, tmp_path, wait_until):
    line = "lcmtools pub /c std_msgs/String "
    prototype = {"fish": "\\{data:\\ \\'\\'\\}"}.get(shell, "\"{data: ''}\"")
    completes(line, f"{line}{prototype}")
    terminal.type("-1", "Enter")
    wait_until(lambda: "no node subscribes to /c" in terminal.screen())
    assert tmp_path.exists()


def test_a_bus_that_is_wrong_leaves_the_prompt_as_it_was(terminal, wait_until, shell):
    setting = "set -x" if shell == "fish" else "export"
    gap = " " if shell == "fish" else "="
    terminal.type(f"{setting} LCM_DEFAULT_URL{gap}nonsense; clear")
    wait_until(lambda: terminal.screen().endswith("nonsense; clear"))
    terminal.type("Enter")
    wait_until(lambda: terminal.screen() == PROMPT.strip())
    terminal.type("lcmtools echo /a", "Tab")
    terminal.type("x")
    wait_until(lambda: terminal.screen() == f"{PROMPT}lcmtools echo /ax")


@pytest.mark.usefixtures("shell")
def test_files_are_left_to_the_shell(completes, tmp_path):
    (tmp_path / "messages.yaml").touch()
    completes("lcmtools pub -f mess", "lcmtools pub -f messages.yaml")


@pytest.mark.parametrize("name", SHELLS)
def test_the_shell_finds_no_mistake_in_its_script(name, tmp_path):
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    wanted = plan(name, {"HOME": str(tmp_path)})
    list(install(name, wanted))
    for file in filter(None, (wanted.script, wanted.settings)):
        ended = subprocess.run([name, "-n", str(file)], capture_output=True, text=True, check=False)
        assert (ended.returncode, ended.stderr) == (0, "")
