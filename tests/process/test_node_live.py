"""Nodes in processes of their own, over the real bus."""

import os
import signal

import lcm
import pytest
from fixtures.says import assert_says

from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import decode, encode
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.rosgraph_msgs import Log
from lcmtools.types.std_msgs import String

_ECHOER = """
import lcmtools
from lcmtools.types.std_msgs import String

class Echoer(lcmtools.Node):
    def __init__(self):
        super().__init__("echoer")
        self.answers = self.create_publisher(String, "answers")
        self.create_subscription(String, "questions", self.take)
        self.get_logger().info(f"I am {self.name}")
        print("ready")

    def take(self, message):
        self.answers.publish(message)

lcmtools.init()
lcmtools.spin(Echoer())
lcmtools.shutdown()
"""

_FAILING = """
import lcmtools

class Controller(lcmtools.Node):
    def __init__(self):
        super().__init__("controller")
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.speed += 1

lcmtools.init()
lcmtools.spin(Controller())
"""

_SERVER = """
import lcmtools
from lcmtools.types.std_srvs import SetBool
lcmtools.init()
node = lcmtools.Node("server")
def switch(request, response):
    response.success, response.message = request.data, "done"
    return response
node.create_service(SetBool, "switch", switch)
print("ready")
lcmtools.spin(node)
lcmtools.shutdown()
"""

_CALLER = """
import sys
import lcmtools
from lcmtools.types.std_srvs import SetBool
lcmtools.init()
node = lcmtools.Node("caller")
client = node.create_client(SetBool, "switch")
request = SetBool.Request()
request.data = True
def ask():
    response = client.call(request, timeout=40.0)
    print("answer", response.success, response.message)
    lcmtools.shutdown()
node.create_timer(0.01, ask)
lcmtools.spin(node)
"""


def test_a_plain_lcm_program_and_a_node_talk(start_python, bus_url, wait_until):
    node = start_python(_ECHOER, "__ns:=/x", "answers:=/news", "--lcm-url", bus_url)
    node.wait_for("ready")
    heard = []
    plain = lcm.LCM(bus_url)
    plain.subscribe("/news", lambda _, payload: heard.append(decode(String, payload).data))
    question = String()
    question.data = "été?"
    plain.publish("/x/questions", encode(question))
    wait_until(lambda: plain.handle_timeout(20) and heard)
    assert heard == ["été?"]
    assert node.lines[0].startswith("[INFO] [")
    assert node.lines[0].endswith("[/x/echoer]: I am /x/echoer")


def test_a_node_gets_another_name(start_python, bus_url):
    node = start_python(_ECHOER, "__name:=bob", LCM_DEFAULT_URL=bus_url)
    node.wait_for("ready")
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        (found,) = watch.settle(foreign=False).nodes
    assert found.name == "/bob"
    assert found.pid == node.pid
    assert found.command.endswith(".py __name:=bob")
    topics = {e.topic for e in found.endpoints}
    assert topics == {"/rosout", "/answers", "/questions", "/bob/_parameters"}


def test_rosout_has_what_was_logged(start_python, bus_url):
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        start_python(_ECHOER, LCM_DEFAULT_URL=bus_url)
        packet = next(p for p in watch.packets(15.0) if p.channel == "/rosout")
    entry = decode(Log, packet.payload)
    assert (entry.level, entry.name, entry.msg) == (Log.INFO, "/echoer", "I am /echoer")
    assert (entry.function, entry.line) == ("__init__", 10)
    assert entry.file.startswith("script_")


def test_a_callback_that_fails_is_announced_and_its_traceback_printed_once(start_python, bus_url):
    node = start_python(_FAILING, LCM_DEFAULT_URL=bus_url)
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        node.wait_for("times more")
        (found,) = watch.settle(foreign=False).nodes
    (error,) = found.errors
    assert (error.callback, error.exception) == ("timer 0.02 s", "AttributeError")
    assert error.place == "script_0.py:10"
    assert error.message == "'Controller' object has no attribute 'speed'"
    assert error.count > 1
    node.send_signal(signal.SIGTERM)
    assert node.wait() == 0
    assert node.output.count("Traceback") == 1
    assert "self.speed += 1" in node.output


@pytest.mark.parametrize("server_first", [True, False])
def test_a_service_is_called_from_another_process(start_python, bus_url, *, server_first):
    """Whichever starts first: the request is repeated until there is somebody to hear it."""
    order = [_SERVER, _CALLER] if server_first else [_CALLER, _SERVER]
    first, second = (start_python(source, LCM_DEFAULT_URL=bus_url) for source in order)
    caller = second if server_first else first
    assert caller.wait() == 0, caller.output
    assert caller.lines == ["answer True done"]


@pytest.mark.usefixtures("bus_url")  # it needs multicast, too
def test_a_domain_is_a_bus_of_its_own(start_python):
    node = start_python(
        "import lcmtools; lcmtools.init(); print(lcmtools.Node('a').context.bus.url)",
        "--domain",
        "232",
    )
    assert node.wait() == 0
    assert node.lines == ["udpm://239.255.76.67:7899?ttl=0"]


@pytest.mark.usefixtures("bare_network")
def test_without_multicast_init_says_what_to_type(start_python):
    node = start_python(
        "import lcmtools\ntry:\n    lcmtools.init()\n"
        "except lcmtools.LcmtoolsError as error:\n    print(error)\n"
    )
    assert node.wait() == 0
    (line,) = node.lines
    assert_says(line, "multicast", "239.255.76.67:7667; type: sudo ip link set lo up")


def test_a_node_on_tcpq_works_without_multicast(start_python, tcpq_server, wait_until):
    url = tcpq_server.url
    server = start_python(_SERVER, LCM_DEFAULT_URL=url)
    caller = start_python(_CALLER, LCM_DEFAULT_URL=url)
    assert caller.wait() == 0, caller.output
    assert "answer True done" in caller.lines
    with BusMonitor(parse_url(url), "test", os.environ) as watch:
        wait_until(lambda: [n.name for n in watch.settle().nodes if not n.stale] == ["/server"])
    server.send_signal(2)
    assert server.wait() == 0
