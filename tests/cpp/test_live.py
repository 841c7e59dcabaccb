"""A node in C++ on a bus, beside nodes and commands in Python."""

import json
import os
import signal
import socket
import struct
import threading
import time
from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools import Node
from lcmtools.bag.rerunning.private_bus import PrivateBus
from lcmtools.bus.kernel import receive_buffer_bytes
from lcmtools.bus.open import open_bus
from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import parse_url
from lcmtools.errors import ServiceError
from lcmtools.graph.protocol import (
    ANSWER_SPREAD,
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Probe,
    decode_announcement,
    encode_probe,
)
from lcmtools.packages.cmake import compiler_flags
from lcmtools.types.rosgraph_msgs import Clock, Log
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import SetBool
from lcmtools.wire.tcpq import PUBLISH, SERVER_GREETING, FrameReader

NAME = "/husky0/everything"
PROGRAMS = Path(__file__).parent / "programs"


@pytest.fixture(autouse=True)
def on_bus(bus_url, monkeypatch):
    """A bus of the test's own."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)


@pytest.fixture
def everything(node_program, start, cli, wait_until):
    """``everything("_gain:=2")``: the program, once its node is listed."""

    def run(*words):
        program = start(str(node_program), "__ns:=/husky0", *words)
        wait_until(lambda: f'"pid": {program.pid},' in cli("node", "list", "--json").out)
        return program

    return run


class Talk:
    """A Python node that talks to the one in C++."""

    def __init__(self, start_node):
        self.node = start_node(lambda: Node("talk")).node
        self.words = self.node.create_publisher(String, "/husky0/words")
        self.asks = self.node.create_publisher(String, "/husky0/ask")
        self.heard = []
        self.log = []
        self.node.create_subscription(String, "/husky0/echo", lambda m: self.heard.append(m.data))
        self.node.create_subscription(Log, "/rosout", self.log.append, 100)

    def say(self, text, to=None):
        """Send a word."""
        message = String()
        message.data = text
        (to or self.words).publish(message)


@pytest.fixture
def talk(start_node):
    """A Python node on the same bus."""
    return Talk(start_node)


def test_it_is_listed_with_its_topics_and_types(everything, cli):
    everything("words:=/renamed")
    assert NAME in cli("node", "list").out.splitlines()
    info = cli("node", "info", NAME).out
    assert_says(info, "/husky0/echo [std_msgs/String]", "/rosout [rosgraph_msgs/Log]")
    assert_says(info, "PLAIN [geometry_msgs/Twist]", "/renamed [std_msgs/String]")
    assert_says(info, "/husky0/refuse [std_srvs/SetBool]")
    assert "/husky0/words" not in info


def test_rates_and_senders_are_known(everything, cli, wait_until):
    program = everything()
    wait_until(
        lambda: "rate: 10" in cli("info", "PLAIN").out or "rate: 9.9" in cli("info", "PLAIN").out
    )
    assert f"pid {program.pid}" in cli("info", "PLAIN").out
    findings = cli("wtf").out
    assert "not announced" not in findings
    assert f"pid {program.pid}" not in findings


def test_many_probes_of_one_node_get_few_answers_with_the_last_number(
    everything, bus_url, wait_until
):
    everything()
    payloads = []
    with closing(open_bus(parse_url(bus_url))) as bus:
        bus.subscribe(NODE_CHANNEL, lambda payload, _: payloads.append(payload))
        began = time.monotonic()
        for nonce in range(1, 501):
            bus.publish(PROBE_CHANNEL, encode_probe(Probe(NAME, nonce)))
            bus.publish(PROBE_CHANNEL, encode_probe(Probe(f"/nobody{nonce}", nonce)))
            if nonce % 50 == 0:  # more at once may overflow the system's buffer
                wait_until(lambda n=nonce: n in _answers(payloads))
    answers = [nonce for nonce in _answers(payloads) if nonce]
    assert len(answers) <= 2 + (time.monotonic() - began) / ANSWER_SPREAD


def _answers(payloads):
    return [found.answers for one in tuple(payloads) if (found := decode_announcement(one))]


def test_names_on_the_command_line(node_program, start, cli, wait_until):
    start(str(node_program), "__name:=other", "--ns", "a")
    wait_until(lambda: "/a/other" in cli("node", "list").out)


def test_a_plain_channel_is_no_pattern(everything, talk, wait_until):
    everything()
    exact = talk.node.create_publisher(String, "WORDS.*", plain_channel=True)
    other = talk.node.create_publisher(String, "WORDS2", plain_channel=True)
    talk.say("wrong", other)
    talk.say("right", exact)
    wait_until(lambda: talk.heard)
    assert talk.heard[0].startswith("right")


def test_the_newest_messages_are_kept_and_drops_counted(everything, talk, cli, wait_until):
    everything()
    is_waiting, goes_on = threading.Event(), threading.Event()

    def answer(_, response):
        is_waiting.set()
        goes_on.wait(40)
        return response

    talk.node.create_service(SetBool, "/husky0/other", answer)
    talk.say("true", talk.asks)  # its callback waits for the answer
    assert is_waiting.wait(40)
    for number in range(10):
        talk.say(str(number))
    goes_on.set()
    wait_until(lambda: any(text.startswith("9 ") for text in talk.heard))
    assert [text.split(" ")[0] for text in talk.heard] == ["", "8", "9"]
    wait_until(lambda: "drops: 8" in cli("info", "/husky0/words").out)


def test_an_exception_is_logged_once_and_counted(everything, talk, cli, wait_until):
    program = everything()
    for number in range(3):
        talk.say("throw")
        talk.say(str(number))
        wait_until(lambda n=number: any(text.startswith(f"{n} ") for text in talk.heard))
    wait_until(lambda: "3 times" in cli("node", "info", NAME).out)
    assert_says(cli("node", "info", NAME).out, "std::out_of_range", "node.cpp:", "no such word")
    assert program.output.count("no such word") == 1
    assert_says(cli("wtf").out, NAME, "std::out_of_range")


def test_parameters_are_read_and_set(everything, cli):
    everything("_gain:=2.5", "_frame:=map")
    assert cli("param", "get", f"{NAME}/gain").out == "2.5\n"
    assert cli("param", "get", f"{NAME}/names").out == '[a, "b c"]\n'
    assert cli("param", "get", f"{NAME}/frame").out == "map\n"
    assert cli("param", "set", NAME, "gain", "4").code == 0
    assert cli("param", "get", f"{NAME}/gain").out == "4.0\n"
    assert_says(cli("param", "set", NAME, "gain", "11").err, "gain", "11", "10")
    assert_says(cli("param", "set", NAME, "gain", "fast").err, "gain", "number", "fast")
    assert_says(cli("param", "set", NAME, "count", "13").err, "13 is unlucky")
    assert_says(cli("param", "set", NAME, "use_sim_time", "true").err, "cannot change")
    assert cli("param", "get", f"{NAME}/count").out == "3\n"


def test_a_wrong_parameter_is_one_line(node_program, start):
    program = start(str(node_program), "_gain:=fast")
    assert program.wait() == 1
    assert program.output == "error: parameter gain: expected a number, got 'fast'"


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--lcm-url", "zenoh://"], "relay"),
        (["--lcm-url", "udp://x"], "no LCM provider"),
        (["--lcm-url", "udpm://239.255.76.67"], "port is missing"),
        (["--domain", "x"], "from 0 to 232"),
        (["__name:=a/b"], "not a legal node name"),
        (["__speed:=3"], "no such special name"),
        (["--ns"], "needs a value"),
    ],
)
def test_wrong_arguments_are_one_line(words, error, node_program, start):
    program = start(str(node_program), *words)
    assert program.wait() == 1
    (line,) = program.lines
    assert_says(line, "error: ", error)


def test_names_that_no_node_uses_are_warned_of(everything):
    words = ("word:=/a", "words:=/b", "echo=c", "gain=3", "_lr=3", "lr=3", "--", "echo=d")
    program = everything(*words)
    program.wait_for("'_lr=3'")
    assert [line.partition("]: ")[2] for line in program.lines if "[WARN]" in line] == [
        "word:=/a has no effect: no topic or service here is named 'word'",
        "'echo=c' names nothing; did you mean echo:=c?",
        "'gain=3' names nothing; did you mean _gain:=3?",
        "'_lr=3' names nothing; did you mean _lr:=3?",
    ]


def test_its_service_answers_and_refuses(everything, talk):
    everything("_gain:=7")
    client = talk.node.create_client(SetBool, "/husky0/refuse")
    request = SetBool.Request()
    request.data = True
    assert client.call(request, 20.0).message == "gain 7"
    request.data = False
    with pytest.raises(ServiceError, match="it must be true"):
        client.call(request, 20.0)


def test_it_calls_asynchronously_while_it_spins(everything):
    program = everything("call")
    program.wait_for("timeout")
    program.send_signal(signal.SIGINT)
    assert program.wait() == 0
    words = ["gain 1", "/husky0/refuse: it must be true", "timeout", "interrupted", "spun"]
    assert program.lines[1:] == words


def test_a_request_is_repeated_until_its_service_is_there(everything, talk):
    program = everything("call")
    program.wait_for("timeout")

    def answer(_, response):
        response.message = "at last"
        return response

    talk.node.create_service(SetBool, "/husky0/nobody", answer)
    program.wait_for("at last")


def test_it_calls_a_service_in_a_callback(everything, talk, wait_until):
    everything()

    def answer(request, response):
        response.message = f"got {request.data}"
        return response

    talk.node.create_service(SetBool, "/husky0/other", answer)
    talk.say("true", talk.asks)
    wait_until(lambda: "got True" in talk.heard)


def test_its_log_is_on_rosout(everything, talk, wait_until):
    program = everything("_gain:=3")
    assert_says(program.wait_for("gain 3"), "[INFO]", NAME)
    talk.say("throw")
    wait_until(lambda: any("no such word" in entry.msg for entry in talk.log))
    entry = next(entry for entry in talk.log if "no such word" in entry.msg)
    assert (entry.name, entry.level, entry.file) == (NAME, Log.ERROR, "node.cpp")


def test_a_log_line_can_be_throttled_and_written_once(everything, talk, wait_until):
    program = everything()
    talk.say("log")
    wait_until(lambda: any("log at" in text for text in talk.heard))
    program.wait_for("always")
    counts = {word: program.output.count(word) for word in ("seldom", "single", "always")}
    assert counts == {"seldom": 1, "single": 1, "always": 3}


def test_a_rate_keeps_its_turns(everything, talk, wait_until):
    everything()
    talk.say("rate")
    wait_until(lambda: any("rate at" in text for text in talk.heard))
    assert "two turns" in talk.heard


def test_simulated_time_is_that_of_the_clock(everything, talk, cli, wait_until):
    everything("_use_sim_time:=true")
    clock = talk.node.create_publisher(Clock, "/clock")

    def set_time(seconds):
        message = Clock()
        message.clock.sec = seconds
        clock.publish(message)
        talk.say(f"now{seconds}")

    set_time(5)
    wait_until(lambda: "now5 at 5.0" in talk.heard)
    set_time(6)
    wait_until(lambda: "now6 at 6.0" in talk.heard)
    wait_until(lambda: "messages: 2," in cli("info", "PLAIN").out)  # one for each jump


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_ends_it_with_a_goodbye(number, everything, cli):
    program = everything()
    program.send_signal(number)
    assert program.wait() == 0
    assert program.lines[-1] == "spun"
    assert NAME not in cli("node", "list").out


def test_node_kill_ends_it(everything, cli):
    program = everything()
    assert cli("node", "kill", NAME).code == 0
    assert program.wait() == 0
    program.wait_for("shutdown requested by")


def test_a_second_signal_ends_a_hanging_callback_with_a_goodbye(everything, talk, cli, wait_until):
    program = everything()
    talk.say("hang")
    wait_until(lambda: "hangs" in talk.heard)
    program.send_signal(signal.SIGINT)
    time.sleep(0.1)  # longer than for one signal that comes twice
    program.send_signal(signal.SIGTERM)
    assert program.wait() == -signal.SIGTERM
    assert NAME not in cli("node", "list").out


def test_a_killed_one_is_noticed(everything, cli):
    program = everything()
    program.send_signal(signal.SIGKILL)
    program.wait()
    assert_says(cli("wtf").out, NAME, str(program.pid))


def test_its_receive_buffer_is_as_large_as_the_system_grants(everything):
    """A plain LCM program sends an image in one burst."""
    program = everything()
    links = [str(one.readlink()) for one in Path(f"/proc/{program.pid}/fd").iterdir()]
    inodes = [int(link[8:-1]) for link in links if link.startswith("socket:")]
    sizes = SocketTable.read().buffers
    assert 2 * receive_buffer_bytes() in [sizes.get(inode) for inode in inodes]


def test_its_record_has_the_keys_and_the_namespaces_of_one_of_python(everything, talk):
    everything()
    files = Path(os.environ["XDG_RUNTIME_DIR"]).glob("lcmtools/records/*/*.json")
    records = {record["name"]: record for record in map(json.loads, map(Path.read_text, files))}
    ours, python = records[NAME], records[talk.node.name]
    assert sorted(ours) == sorted(python)
    for key in ("network", "network_cookie", "pid_namespace"):
        assert ours[key] == python[key]


def test_on_tcpq_half_a_message_holds_up_no_timer(node_program, start):
    """Liblcm waits for the rest: not on the thread that runs the callbacks."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(60)
        start(str(node_program), "--lcm-url", f"tcpq://127.0.0.1:{server.getsockname()[1]}")
        client, _ = server.accept()
        reader, counts = FrameReader(), Counter[str]()
        with client:
            client.settimeout(60)
            client.sendall(SERVER_GREETING)
            half = struct.pack(">II6sI", PUBLISH, 6, b"/words", 1_000_000) + bytes(1000)
            while counts["PLAIN"] < 5:
                before = counts["PLAIN"]
                counts.update(one.name for one in reader.read(client.recv(1 << 16)))
                if not before and counts["PLAIN"]:
                    client.sendall(half)


def test_a_tcpq_server_gets_the_messages_of_two_threads_whole(compiled, compiler, start):
    source = PROGRAMS / "two_threads.cpp"
    program = compiled("two_threads", compiler, "-O0", source, *compiler_flags())
    heard = Counter()
    with PrivateBus() as bus:
        runner = start(str(program), LCM_DEFAULT_URL=bus.url)
        while not bus.count or bus.clients:
            heard.update((one.channel, one.payload) for one in bus.turn(1.0))
        assert runner.wait() == 0
    assert (bus.count, heard["/words", b"whole"]) == (1, 6000)
    assert {channel for channel, _ in heard} <= {"/words", "/rosout", NODE_CHANNEL}
