"""A node in C++ under AddressSanitizer and ThreadSanitizer, as it talks with nodes in Python."""

import signal
from pathlib import Path

import pytest

from lcmtools import Node
from lcmtools.packages.cmake import compiler_flags
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import SetBool


@pytest.fixture(params=["address,undefined", "thread"])
def program(request, compiled, compiler, cli, tmp_path):
    """The program node.cpp with a sanitizer."""
    source = Path(__file__).parent / "programs" / "node.cpp"
    kinds = ("std_msgs", "std_srvs", "geometry_msgs/Twist")
    assert cli("msg", "generate", "--lang", "cpp", str(tmp_path / "types"), *kinds).code == 0
    options = ("-O0", f"-fsanitize={request.param}", f"-I{tmp_path / 'types'}")
    name = f"node-{request.param.split(',')[0]}"
    return compiled(name, compiler, *options, source, *compiler_flags())


@pytest.fixture
def on_bus(bus_url, monkeypatch):
    """A bus of the test's own."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.mark.usefixtures("on_bus")
def test_no_fault_is_found(program, start, start_node, cli, wait_until):
    running = start(str(program), "call")
    wait_until(lambda: "/everything" in cli("node", "list").out)
    node = start_node(lambda: Node("talk")).node
    words = node.create_publisher(String, "/words")
    heard = []
    node.create_subscription(String, "/echo", lambda m: heard.append(m.data), 100)
    message = String()
    for message.data in ("throw", "log", "rate"):
        words.publish(message)
        wait_until(lambda: message.data == "throw" or any(message.data in one for one in heard))
    assert cli("param", "set", "/everything", "gain", "3").code == 0
    request = SetBool.Request()
    request.data = True
    client = node.create_client(SetBool, "/refuse")
    assert client.call(request, 20.0).message == "gain 3"
    assert cli("node", "ping", "/everything", "-c", "2").code == 0
    running.send_signal(signal.SIGINT)
    assert running.wait() == 0
    assert "Sanitizer" not in running.output, running.output
