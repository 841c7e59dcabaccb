"""``lcmtools service``: real nodes, called from a shell."""

import json
import os
import signal
from collections.abc import Callable
from subprocess import CompletedProcess
from typing import Any

import pytest

Run = Callable[..., CompletedProcess[str]]
Start = Callable[..., Any]

SERVER = """
import sys, time
import lcmtools
from lcmtools.types.std_srvs import Empty, SetBool, Trigger

lcmtools.init()
node = lcmtools.Node("server")
calls = []

def switch(request, response):
    calls.append(request.data)
    response.success, response.message = request.data, f"call {len(calls)}"
    return response

def slow(request, response):
    print("slow begins", flush=True)
    time.sleep(0.8)  # over several repetitions of the request
    calls.append(True)
    response.success, response.message = True, f"{len(calls)}" + "x" * 300_000
    return response

def fail(request, response):
    raise RuntimeError("no power")

node.create_service(SetBool, "switch", switch)
node.create_service(Trigger, "~slow", slow)
node.create_service(Trigger, "fail", fail)
node.create_service(Empty, "reset", lambda _, response: response)
node.create_service(Empty, "/_inner", lambda _, response: response)
print("ready", flush=True)
lcmtools.spin(node)
lcmtools.shutdown()
"""


@pytest.fixture(scope="module")
def server(module_start: Start, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A node with services, on the module's bus."""
    import sys

    script = tmp_path_factory.mktemp("server") / "server.py"
    script.write_text(SERVER)
    program = module_start(sys.executable, str(script))
    program.wait_for("ready")
    return program


@pytest.fixture
def on_bus(bus_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bus of the test's own, for everything that it starts."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


shared_server = pytest.mark.usefixtures("use_module_bus", "server")


@shared_server
def test_list_names_services_with_types_and_nodes(lcmtools: Run) -> None:
    plain = ["/fail", "/reset", "/server/slow", "/switch"]
    assert lcmtools("service", "list").stdout.splitlines() == plain
    everything = lcmtools("service", "list", "-a").stdout.splitlines()
    assert everything == sorted([*plain, "/_inner", "/server/_parameters"])
    assert "/switch [std_srvs/SetBool] /server\n" in (
        lcmtools("service", "list", "-t", "-n").stdout
    )
    assert lcmtools("service", "list", "/server").stdout == "/server/slow\n"
    records = json.loads(lcmtools("service", "list", "--json").stdout)
    assert records[0] == {
        "service": "/fail",
        "types": ["std_srvs/Trigger"],
        "nodes": ["/server"],
        "stale": False,
    }


@shared_server
def test_info_type_find_and_args(lcmtools: Run, server: Any) -> None:
    info = lcmtools("service", "info", "switch").stdout.splitlines()
    assert info[0] == "Node: /server"
    assert f"Pid: {server.pid}" in info
    assert info[-2:] == ["Type: std_srvs/SetBool", "Args: data"]
    (record,) = json.loads(lcmtools("service", "info", "/switch", "--json").stdout)
    assert (record["args"], record["servers"][0]["pid"]) == (["data"], server.pid)
    assert lcmtools("service", "type", "/switch").stdout == "std_srvs/SetBool\n"
    assert lcmtools("service", "args", "/switch").stdout == "data\n"
    found = lcmtools("service", "find", "std_srvs/srv/Trigger").stdout.splitlines()
    assert found == ["/fail", "/server/slow"]


@shared_server
def test_call_repeats_as_often_as_is_said(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "-t", "3", "-r", "100", "/switch", "true", "--json")
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    numbers = [int(row["message"].removeprefix("call ")) for row in rows]
    assert numbers == [numbers[0], numbers[0] + 1, numbers[0] + 2]
    assert done.returncode == 0
    failed = lcmtools("service", "call", "-t", "2", "-r", "100", "/switch", "false")
    assert failed.stdout.count("---\n") == 2
    assert failed.returncode == 1


@shared_server
def test_call_with_a_rate_goes_on_until_ctrl_c(start: Start, lcmtools_path: str) -> None:
    call = start(lcmtools_path, "service", "call", "-r", "100", "/switch", "true")
    for _ in range(5):
        call.wait_for("success: True")
    call.send_signal(signal.SIGINT)
    assert call.wait() == 130
    assert all(line in ("success: True", "---") or "call" in line for line in call.lines)


@shared_server
def test_call_with_a_rate_ends_where_the_service_fails(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "-r", "100", "/fail")
    assert (done.returncode, done.stdout) == (1, "")
    assert "no power" in done.stderr


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
def test_call_prints_the_response_for_any_spelling(lcmtools: Run, words: list[str]) -> None:
    done = lcmtools("service", "call", *words)
    assert done.stdout.startswith('success: True\nmessage: "call ')
    assert (done.returncode, done.stderr) == (0, "")


@shared_server
def test_a_response_without_success_is_printed_and_exits_with_1(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "/switch", "false", "--json")
    assert json.loads(done.stdout)["success"] is False
    assert (done.returncode, done.stderr) == (1, "")


@shared_server
def test_a_service_that_fails_exits_with_1_and_its_reason(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "/fail")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "lcmtools service call: /fail: RuntimeError('no power')\n"


@shared_server
def test_an_empty_response_is_an_empty_line(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "/reset")
    assert (done.returncode, done.stdout) == (0, "\n")


@shared_server
def test_requests_that_are_piped_in_are_answered_in_order(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "/switch", stdin="data: true\n---\ndata: false\n")
    assert done.stdout.count("---\n") == 2
    assert done.stdout.index("success: True") < done.stdout.index("success: False")
    assert done.returncode == 1


@shared_server
def test_a_bad_request_in_a_file_sends_none(lcmtools: Run) -> None:
    before = lcmtools("service", "info", "/switch").stdout
    done = lcmtools("service", "call", "/switch", "-f", "-", stdin="data: true\n---\ndata: 7\n")
    assert (done.returncode, done.stdout) == (2, "")
    assert "standard input: document 2, line 3: data: expected true or false" in done.stderr
    assert lcmtools("service", "info", "/switch").stdout == before


@shared_server
def test_a_slow_service_with_a_large_response_is_called_once(lcmtools: Run) -> None:
    first, second = (
        lcmtools("service", "call", "/server/slow", "--timeout", "10s", "--json") for _ in range(2)
    )
    counts = [int(json.loads(d.stdout)["message"].rstrip("x")) for d in (first, second)]
    assert counts[1] == counts[0] + 1


@shared_server
def test_no_answer_in_time_exits_with_4_and_names_the_node(lcmtools: Run, server: Any) -> None:
    done = lcmtools("service", "call", "/server/slow", "--timeout", "200ms")
    assert (done.returncode, done.stdout) == (4, "")
    assert "/server/slow did not answer within 0.2 s" in done.stderr
    assert f"its node /server (pid {server.pid}) runs" in done.stderr


@pytest.mark.usefixtures("on_bus")
def test_a_server_that_is_killed_in_the_middle_is_named(
    lcmtools: Run, start: Start, start_python: Start, lcmtools_path: str
) -> None:
    server = start_python(SERVER)
    server.wait_for("ready")
    call = start(lcmtools_path, "service", "call", "/server/slow", "--timeout", "2s")
    server.wait_for("slow begins")
    os.kill(server.pid, signal.SIGKILL)
    call.wait_for("its node /server ended without saying goodbye")
    assert call.wait() == 4
    assert lcmtools("service", "call", "/switch").returncode == 1


@pytest.mark.usefixtures("on_bus")
def test_wait_says_what_it_waits_for_and_calls_when_the_service_is_there(
    start: Start, start_python: Start, lcmtools_path: str
) -> None:
    call = start(lcmtools_path, "service", "call", "--wait", "/switch", "true")
    line = call.wait_for("waiting for")
    assert "waiting for the service /switch; no node offers any" in line
    start_python(SERVER)
    call.wait_for("success: True")
    assert call.wait() == 0


@pytest.mark.usefixtures("on_bus")
def test_wait_with_a_duration_gives_up_with_exit_code_4(lcmtools: Run) -> None:
    done = lcmtools("service", "call", "--wait=200ms", "/switch", "true")
    assert done.returncode == 4
    assert done.stderr.startswith("lcmtools service call: no node offers /switch within 0.2 s")


@pytest.mark.usefixtures("on_bus")
def test_two_nodes_with_the_same_service_are_said(lcmtools: Run, start_python: Start) -> None:
    for name in ("one", "two"):
        start_python(SERVER, f"__name:={name}").wait_for("ready")
    done = lcmtools("service", "call", "/switch", "true")
    assert done.returncode == 0
    assert "2 nodes offer /switch: /one (" in done.stderr


@pytest.mark.usefixtures("on_bus")
def test_a_call_ends_at_once_with_ctrl_c(
    start: Start, start_python: Start, lcmtools_path: str, stopwatch: Callable[..., Any]
) -> None:
    server = start_python(SERVER)
    server.wait_for("ready")
    call = start(lcmtools_path, "service", "call", "/server/slow", "--timeout", "30s")
    server.wait_for("slow begins")
    watch = stopwatch(call.pid)
    call.send_signal(signal.SIGINT)
    assert watch.until_end() < 3.0  # seconds
    assert call.wait() == 130
    assert call.output == ""
