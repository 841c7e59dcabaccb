"""Nodes in processes of their own, over the real bus."""

import os

import lcm
import pytest

from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import decode, encode
from lcmtools.observe.reading.monitor import BusMonitor
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


@pytest.mark.parametrize("server_first", [True, False])
def test_a_service_is_called_from_another_process(start_python, bus_url, *, server_first):
    """Whichever starts first: the request is repeated until there is somebody to hear it."""
    order = [_SERVER, _CALLER] if server_first else [_CALLER, _SERVER]
    first, second = (start_python(source, LCM_DEFAULT_URL=bus_url) for source in order)
    caller = second if server_first else first
    assert caller.wait() == 0, caller.output
    assert caller.lines == ["answer True done"]


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
