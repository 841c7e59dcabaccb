"""``lcmtools service``: real nodes, called from a shell."""

import json
import os
import signal
import threading
import time

import pytest
from fixtures.says import assert_says

from lcmtools import Node
from lcmtools.publish import subscriber_wait
from lcmtools.types.std_srvs import Empty, SetBool, Trigger


class Server(Node):
    """A node with services."""

    def __init__(self):
        super().__init__("server")
        self.is_slow = threading.Event()
        self._calls = 0
        self.create_service(SetBool, "switch", self._switch)
        self.create_service(Trigger, "~slow", self._be_slow)
        self.create_service(Trigger, "fail", self._fail)
        self.create_service(Empty, "reset", lambda _, response: response)
        self.create_service(Empty, "/_inner", lambda _, response: response)

    def _switch(self, request, response):
        self._calls += 1
        response.success, response.message = request.data, f"call {self._calls}"
        return response

    def _be_slow(self, _, response):
        self.is_slow.set()
        time.sleep(0.8)  # over several repetitions of the request
        self._calls += 1
        response.success, response.message = True, f"{self._calls}" + "x" * 300_000
        return response

    def _fail(self, _request, _response):
        raise RuntimeError("no power")


@pytest.fixture(scope="module")
def server(module_start_node):
    """A node with services, on the module's bus."""
    return module_start_node(Server).node


shared_server = pytest.mark.usefixtures("use_module_bus", "server")


@shared_server
def test_list_names_services_with_types_and_nodes(cli, wait_until):
    plain = ["/fail", "/reset", "/server/slow", "/switch"]
    wait_until(lambda: cli("service", "list").out.splitlines() == plain)
    everything = cli("service", "list", "-a").out.splitlines()
    assert everything == sorted([*plain, "/_inner", "/server/_parameters"])
    assert "/switch [std_srvs/SetBool] /server\n" in (cli("service", "list", "-t", "-n").out)
    assert cli("service", "list", "/server").out == "/server/slow\n"
    records = json.loads(cli("service", "list", "--json").out)
    assert records[0] == {
        "service": "/fail",
        "types": ["std_srvs/Trigger"],
        "nodes": ["/server"],
        "stale": False,
    }


@shared_server
def test_call_repeats_as_often_as_is_said(cli):
    done = cli("service", "call", "-t", "3", "-r", "100", "/switch", "true", "--json")
    rows = [json.loads(line) for line in done.out.splitlines()]
    numbers = [int(row["message"].removeprefix("call ")) for row in rows]
    assert numbers == [numbers[0], numbers[0] + 1, numbers[0] + 2]
    assert done.code == 0
    failed = cli("service", "call", "-t", "2", "-r", "100", "/switch", "false")
    assert failed.out.count("---\n") == 2
    assert failed.code == 1


@shared_server
def test_call_with_a_rate_goes_on_until_ctrl_c(cli):
    words = ("service", "call", "-r", "100", "/switch", "true")
    done = cli(*words, until=lambda written: written.count("success: True") > 4)
    assert (done.code, done.err) == (130, "")
    rows = done.out.splitlines()
    assert all(line in ("success: True", "---") or "call" in line for line in rows)


@shared_server
def test_call_with_a_rate_ends_where_the_service_fails(cli):
    done = cli("service", "call", "-r", "100", "/fail")
    assert (done.code, done.out) == (1, "")
    assert "no power" in done.err


@shared_server
@pytest.mark.parametrize(
    "words",
    [
        ["/switch", "data: true"],
        ["switch", "true"],
        ["/switch", "std_srvs/SetBool", "{data: yes}"],
        ["/switch", "std_srvs/srv/SetBool", "[on]"],
        ["/switch", "SetBool", '{"data": true}'],
    ],
)
def test_call_prints_the_response_for_any_spelling(cli, words):
    done = cli("service", "call", *words)
    assert done.out.startswith('success: True\nmessage: "call ')
    assert (done.code, done.err) == (0, "")


@shared_server
@pytest.mark.parametrize(
    "words",
    [["slow", "__ns:=/server"], ["--ns", "/server", "slow"], ["other", "other:=/server/slow"]],
)
def test_call_resolves_names_as_the_other_commands_do(cli, words):
    assert cli("service", "call", *words).out.startswith("success: True")


@shared_server
def test_a_response_without_success_is_printed_and_exits_with_1(cli):
    done = cli("service", "call", "/switch", "false", "--json")
    assert json.loads(done.out)["success"] is False
    assert (done.code, done.err) == (1, "")


@shared_server
def test_a_service_that_fails_exits_with_1_and_its_reason(cli):
    done = cli("service", "call", "/fail")
    assert (done.code, done.out) == (1, "")
    assert done.err == "lcmtools service call: /fail: RuntimeError('no power')\n"


@shared_server
def test_an_empty_response_is_an_empty_line(cli):
    done = cli("service", "call", "/reset")
    assert (done.code, done.out) == (0, "\n")


@shared_server
@pytest.mark.parametrize("words", [[], ["-"], ["-f", "-"]])
def test_requests_that_are_piped_in_are_answered_in_order(words, cli):
    done = cli("service", "call", "/switch", *words, input="data: true\n---\ndata: false\n")
    assert done.out.count("---\n") == 2
    assert done.out.index("success: True") < done.out.index("success: False")
    assert done.code == 1


@shared_server
def test_a_bad_request_in_a_file_sends_none(cli):
    before = cli("service", "info", "/switch").out
    done = cli("service", "call", "/switch", "-f", "-", input="data: true\n---\ndata: 7\n")
    assert (done.code, done.out) == (2, "")
    assert_says(done.err, "standard input: document 2, line 3: data: ", "true", "false")
    assert cli("service", "info", "/switch").out == before


@shared_server
def test_no_answer_in_time_exits_with_4_and_names_the_node(cli):
    done = cli("service", "call", "/server/slow", "--timeout", "200ms")
    assert (done.code, done.out) == (4, "")
    assert_says(done.err, "/server/slow", "not answer", "0.2 s")
    assert_says(done.err, f"/server (pid {os.getpid()})", "running")


_MORTAL_SERVER = """
import time
import lcmtools
from lcmtools.types.std_srvs import Trigger

def slow(request, response):
    print("slow begins", flush=True)
    time.sleep(30)
    return response

lcmtools.init()
node = lcmtools.Node("server")
node.create_service(Trigger, "~slow", slow)
print("ready", flush=True)
lcmtools.spin(node)
"""


@pytest.mark.usefixtures("on_bus")
def test_a_server_that_is_killed_in_the_middle_is_named(cli, start_python):
    server = start_python(_MORTAL_SERVER)
    server.wait_for("ready")

    def kill(_):
        if "slow begins" in server.lines:
            os.kill(server.pid, signal.SIGKILL)
        return False

    done = cli("service", "call", "/server/slow", "--timeout", "500ms", until=kill)
    assert done.code == 4
    assert_says(done.err, "/server ended without saying goodbye")
    assert cli("service", "call", "/server/slow").code == 1


@pytest.mark.usefixtures("on_bus")
def test_wait_says_what_it_waits_for_and_calls_when_the_service_is_there(
    cli, start_node, monkeypatch
):
    monkeypatch.setattr(subscriber_wait, "_PATIENCE", 0.1)
    node = start_node(lambda: Node("late")).node
    made = []

    def offer(written):
        if "waiting for the service /switch; no node offers any\n" in written and not made:
            made.append(node.create_service(SetBool, "switch", lambda _, response: response))
        return False

    done = cli("service", "call", "--wait", "/switch", "true", until=offer)
    assert done.out.startswith("success: False")
    assert done.code == 1


@pytest.mark.usefixtures("on_bus")
def test_wait_with_a_duration_gives_up_with_exit_code_4(cli):
    done = cli("service", "call", "--wait=200ms", "/switch", "true")
    assert done.code == 4
    assert_says(done.err, "lcmtools service call: no node", "/switch", "0.2 s")


@pytest.mark.usefixtures("on_bus")
def test_two_nodes_with_the_same_service_are_said(cli, start_node):
    for name in ("one", "two"):
        start_node(Server, f"__name:={name}")
    done = cli("service", "call", "/switch", "true")
    assert done.code == 0
    assert "2 nodes offer /switch: /one (" in done.err


@shared_server
def test_a_call_ends_at_once_with_ctrl_c(cli, server):
    server.is_slow.clear()
    started = time.monotonic()
    words = ("service", "call", "/server/slow", "--timeout", "1000s")
    done = cli(*words, until=lambda _: server.is_slow.is_set())
    assert (done.code, done.out, done.err) == (130, "", "")
    assert time.monotonic() - started < 500  # seconds, of the 1000 that it would wait
