"""Plain LCM programs in C and C++ that announce themselves, beside tools in Python."""

import json
import shutil
import signal
from pathlib import Path

import lcm
import pytest
from fixtures.says import assert_says

from lcmtools import __version__
from lcmtools.graph import protocol
from lcmtools.graph.model import Endpoint, Role
from lcmtools.messages.codec import encode
from lcmtools.packages.cmake import compiler_flags, cpp_folder
from lcmtools.types import lcmtools_msgs as msgs

_STRICT = ("-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsanitize=address,undefined")


@pytest.fixture(params=["c", "cpp"])
def program(request, compiled, compiler):
    """The program announcer.c or announcer.cpp, in the oldest language that it is for."""
    gcc = shutil.which("gcc") or pytest.skip("no gcc to compile C programs with")
    languages = {"c": (gcc, "-std=c99", "-D_XOPEN_SOURCE=700"), "cpp": (compiler, "-std=c++11")}
    flags = [flag for flag in compiler_flags() if not flag.startswith("-std")]
    source = Path(__file__).parent / "programs" / f"announcer.{request.param}"
    command = (*languages[request.param], *_STRICT, source, *flags)
    return compiled(f"announcer-{request.param}", *command)


@pytest.fixture
def announce(program, start, bus_url, monkeypatch):
    """``announce("/arm/driver", "listen")``: the program, once it has said all of itself."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)

    def begin(*words):
        running = start(str(program), *words)
        running.wait_for("ready")
        return running

    return begin


@pytest.mark.parametrize("mode", ["publish", "listen"])
def test_it_is_listed_with_its_topics(mode, announce, cli):
    running = announce("lidar_driver", mode)
    assert cli("node", "list").out == "/lidar_driver\n"
    (record,) = json.loads(cli("node", "info", "/lidar_driver", "--json").out)
    assert record["pid"] == running.pid
    assert (record["callback_time"], record["publications"][0]["callbacks"]) == (None, None)
    assert_says(cli("node", "info", "/lidar_driver").out, "In callbacks: not known")
    assert_says(cli("info", "SCAN").out, "Type: sensors/scan_t", "/lidar_driver")
    heard = "/lidar_driver" in cli("info", 'CMD."').out
    assert heard == (mode == "listen")


def test_its_announcement_has_the_bytes_of_python(announce, bus_url):
    payloads = []
    bus = lcm.LCM(bus_url)
    bus.subscribe(protocol.NODE_CHANNEL, lambda _, data: payloads.append(data))
    running = announce("driver", "listen")
    node = None
    while node is None or len(node.endpoints) < 2:
        assert bus.handle_timeout(10_000) > 0
        node = protocol.decode_announcement(payloads[-1]).node
    assert encode(msgs.Announcement.decode(payloads[-1])) == payloads[-1]
    assert (node.name, node.pid, node.tool) == ("/driver", running.pid, False)
    assert node.software == f"lcmtools C {__version__}"
    assert node.endpoints == (
        Endpoint("SCAN", Role.PUBLISHER, ("sensors/scan_t",), (0x8123456789ABCDEF,)),
        Endpoint('CMD."', Role.SUBSCRIBER, ("cmd_t",), (5,)),
    )


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE])
def test_a_signal_ends_it_with_a_goodbye(number, announce, cli):
    running = announce("driver", "listen")
    assert cli("node", "list").out == "/driver\n"
    running.send_signal(number)
    assert running.wait() == -number
    assert cli("node", "list").out == ""


@pytest.mark.parametrize(("mode", "code"), [("publish", 0), ("exit", 3)])
def test_its_end_is_a_goodbye(mode, code, announce, cli):
    running = announce("driver", mode)
    assert cli("node", "list").out == "/driver\n"
    running.send_signal(signal.SIGUSR1)
    assert running.wait() == code
    assert cli("node", "list").out == ""


def test_node_kill_ends_it(announce, cli):
    running = announce("driver", "listen")
    assert cli("node", "kill", "/driver").code == 0
    assert running.wait() == -signal.SIGTERM


def test_node_ping_reaches_it(announce, cli):
    announce("driver", "listen")
    assert cli("node", "ping", "/driver", "-c", "1").code == 0


def test_a_killed_one_is_noticed(announce, cli):
    running = announce("driver", "publish")
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert_says(cli("wtf").out, "/driver", str(running.pid))


@pytest.mark.parametrize("name", ["", "a b", "a//b", "x" * 63])
def test_an_illegal_name_is_said_in_one_line_and_the_program_goes_on(name, announce, cli):
    running = announce(name, "listen")
    (line,) = (one for one in running.lines if one != "ready")
    assert_says(line, f"lcmtools: '{name}' is not a legal node name")
    assert cli("node", "list").out == ""


def test_the_version_is_that_of_lcmtools():
    assert f'"lcmtools C {__version__}"' in (cpp_folder() / "lcmtools.h").read_text()
