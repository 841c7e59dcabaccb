"""``main`` as Python code and tests call it: again and again, and nothing is left behind."""

import os
import signal
import threading
from pathlib import Path

import pytest

from lcmtools.cli.main import main

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def state():
    """The parts of this process that a command could change."""
    return (
        dict(os.environ),
        [signal.getsignal(number) for number in _SIGNALS],
        threading.enumerate(),
        sorted(str(path.readlink()) for path in Path("/proc/self/fd").iterdir() if path.exists()),
    )


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["list", "--color", "always"], 0),
        (["list", "--debug"], 0),
        (["node", "list", "--no-color", "--json"], 0),
        (["info", "/nothing"], 1),
        (["echo", "/nothing", "--timeout", "10ms"], 4),
        (["pub", "-1", "--literal", "A", "std_msgs/String", "x"], 0),
        (["service", "list"], 0),
        (["run", "talker", "--bogus"], 2),
        (["run", "talker", "a:=b", "--name", "1"], 2),
        (["--bogus"], 2),
    ],
    ids=lambda part: " ".join(part) if isinstance(part, list) else None,
)
def test_command_leaves_nothing_behind_in_the_process(arguments, code, bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    main(arguments)  # what is imported for the first time may open a file for good
    before = state()
    assert main(arguments) == code
    assert state() == before


def test_command_runs_in_any_thread(bus_url, capsys):
    codes = []
    thread = threading.Thread(target=lambda: codes.append(main(["list", "--lcm-url", bus_url])))
    thread.start()
    thread.join(30)
    assert codes == [0]
    assert capsys.readouterr().err == f"no topics on {bus_url}\n"


def test_bus_is_looked_up_when_the_command_runs(monkeypatch, capsys):
    for domain, port in (("3", 7670), ("4", 7671)):
        monkeypatch.setenv("LCMTOOLS_DOMAIN", domain)
        assert main(["config", "--json"]) == 0
        assert f":{port}" in capsys.readouterr().out
