"""Programs tested with recordings, in lock-step and in real time."""

import json
import shlex
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from fixtures.says import assert_says

import lcmtools.bag
from lcmtools import Node
from lcmtools.bag.rerunning.private_bus import PrivateBus
from lcmtools.bag.writer import LogWriter
from lcmtools.errors import UsageError
from lcmtools.packages.cmake import compiler_flags
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.processes.reaper import is_gone
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.sensor_msgs import LaserScan
from lcmtools.types.std_msgs import Float64, Header, String
from lcmtools.wire.packet import Packet, Sender

_NODE = Path(__file__).parent / "programs/played_to.py"
_START, _STEP = 1_700_000_000_000_000_000, 20_000_000  # [ns]
_COUNT = 60


def number(data):
    return Float64(data=data).encode()


def written(path, packets):
    with LogWriter(path, force=True) as log:
        for packet in sorted(packets, key=lambda one: one.time):
            log.add(packet)
    return str(path)


def inputs(count=_COUNT, topic="/in"):
    return [Packet(topic, number(n + 1.0), _START + n * _STEP) for n in range(count)]


def outputs(count=_COUNT, topic="/out"):
    """What was recorded of a doubler: 3 ms after each input."""
    times = (_START + n * _STEP + 3_000_000 for n in range(count))
    return [Packet(topic, number(2.0 * (n + 1)), time) for n, time in enumerate(times)]


@pytest.fixture
def log(tmp_path):
    """A log of a doubler."""
    return written(tmp_path / "doubled.lcmlog", inputs() + outputs())


@pytest.fixture
def rerun(cli, log):
    """``rerun(word..., log=, options=())``: the exit code, and the report as JSON."""

    def run(*words, log=log, options=()):
        program = (sys.executable, str(_NODE), *words)
        done = cli("bag", "rerun", log, "--json", *options, "--", *program)
        return done.code, json.loads(done.out)

    return run


def topic(report, name="/out"):
    return next(one for one in report["topics"] if one["topic"] == name)


def test_a_node_that_does_as_recorded_is_equal(rerun):
    code, report = rerun(options=("--twice",))
    assert (code, report["equal"], report["lockstep"]) == (0, True, True)
    assert (report["inputs"], report["input_topics"]) == (_COUNT, ["/in"])
    found = topic(report)
    assert (found["recorded"], found["now"], found["matched"]) == (_COUNT, _COUNT, _COUNT)
    assert found["delay_recorded"] == pytest.approx(0.003)


def test_a_gain_changed_by_a_percent_is_found_and_named(rerun):
    code, report = rerun("_gain:=2.02")
    found = topic(report)
    assert (code, found["differing"], found["fields"]) == (1, _COUNT, {"data": _COUNT})
    assert found["first"]["recorded"] == 2.0
    assert found["first"]["now"] == pytest.approx(2.02)
    assert found["largest"]["size"] == pytest.approx(1.2)
    assert found["largest"]["time"] == pytest.approx(1.183)
    assert rerun("_gain:=2.02", options=("--relative", "0.011"))[0] == 0


@pytest.mark.parametrize(
    ("words", "key", "expected"),
    [
        pytest.param("_drop_at:=10", "missing", [0.183], id="dropped"),
        pytest.param("_late_at:=10", "late", [[0.183, 0.02]], id="late"),
        pytest.param("_gain:=-2.0", "differing", _COUNT, id="swapped-sign"),
    ],
)
def test_a_wrong_message_is_named(rerun, words, key, expected):
    code, report = rerun(words, options=("--delay", "10ms"))
    assert code == 1
    assert topic(report)[key] == (
        expected if isinstance(expected, int) else [pytest.approx(one) for one in expected]
    )


@pytest.mark.parametrize(
    ("words", "options", "says"),
    [
        (
            "_raise_at:=50",
            (),
            "message 50, at 0.980 s: callback of /in raised ValueError: too large",
        ),
        ("_hang_at:=50", ("--timeout", "5s"), "hangs at message 50 (/in): no answer for 5 s"),
        ("_exit_at:=50", (), "ended with exit code 3, after 50 messages"),
        ("never", ("--timeout", "1s"), "did not connect to the bus within 1 s"),
        ("__ns:=/other", (), "subscribes to /other/in; did you mean /in?"),
        ("out:=elsewhere", (), "it published /elsewhere, which the log does not have"),
        ("", ("--output", "/oot"), "/oot is neither in the log nor published; did you mean /out?"),
    ],
)
def test_a_program_that_fails_is_named_with_its_last_lines(rerun, words, options, says):
    code, report = rerun(words, options=options)
    assert code == 1
    assert_says("\n".join(report["trouble"]), says)
    if "exit" in words:
        assert report["last_lines"] == ["the end is near"]


def test_a_timer_follows_the_time_of_the_log(rerun, tmp_path):
    def tick(n):
        time = _START + n * 250_000_000
        header = Header()
        header.stamp.sec, header.stamp.nsec = divmod(time, 10**9)
        return Packet("/ticks", header.encode(), time + 1_000_000)

    log = written(tmp_path / "t.lcmlog", inputs() + outputs() + [tick(n) for n in range(1, 5)])
    code, report = rerun("_period:=0.25", log=log, options=("--twice",))
    found = topic(report, "/ticks")
    assert (code, found["now"], found["matched"]) == (0, 4, 4), report


def test_a_recorded_clock_is_the_time_of_nodes(rerun, tmp_path):
    def clock(n):
        message = Clock()
        message.clock.sec, message.clock.nsec = divmod(n * _STEP, 10**9)
        return Packet("/clock", message.encode(), _START + n * _STEP)

    ticks = [Packet("/ticks", Header().encode(), _START + n * 250_000_000) for n in range(1, 5)]
    packets = [clock(n) for n in range(_COUNT)] + inputs() + outputs() + ticks
    code, report = rerun("_period:=0.25", log=written(tmp_path / "t.lcmlog", packets))
    found = topic(report, "/ticks")
    assert (code, found["now"]) == (1, 4)
    assert found["first"]["now"] == pytest.approx(0.26)  # the first clock after 0.25 s


def test_an_output_that_the_program_subscribes_to_later_is_passed_on(rerun, tmp_path):
    echo = outputs(topic="/echo")[4:]
    log = written(tmp_path / "e.lcmlog", inputs() + outputs() + echo)
    code, report = rerun("_subscribe_at:=5", log=log, options=("--twice",))
    assert (code, topic(report, "/echo")["matched"]) == (0, _COUNT - 4), report


def test_others_messages_on_a_topic_of_the_program_are_inputs(rerun, tmp_path):
    with LogWriter(tmp_path / "shared.lcmlog") as log:
        names = ("/doubler", "/other")
        own, other = (log.sender_number(Sender("10.0.0.1", n), one) for n, one in enumerate(names))
        log.add(*inputs(1))
        log.add(*outputs(1), own)
        for packet in inputs(topic="/out")[1:]:
            log.add(packet, other)
    code, report = rerun("_subscribe_at:=1", log=str(tmp_path / "shared.lcmlog"))
    assert (code, report["inputs"]) == (0, _COUNT)
    assert (topic(report)["recorded"], topic(report)["matched"]) == (1, 1)


@pytest.mark.parametrize(
    ("word", "code", "reason"),
    [
        ("thread", 0, "it published /chatter without a message or a timer"),
        ("_thread_at:=20", 0, "it published /chatter without a message or a timer"),
        ("loop", 1, "it publishes without waiting for messages (lcmtools.spin)"),
    ],
)
def test_a_program_that_publishes_by_itself_is_played_to_in_real_time(rerun, word, code, reason):
    found, report = rerun(word)
    assert (found, report["real_time"]) == (code, reason)
    assert report["lateness"] >= 0
    assert topic(report)["matched"] == (0 if word == "loop" else _COUNT)


def test_a_plain_c_program_is_played_to_in_real_time(tmp_path, cli):
    compiler = shutil.which("gcc") or pytest.skip("no gcc to compile C programs with")
    source = Path(__file__).parents[2] / "lcm_types/std_msgs/Float64.lcm"
    subprocess.run([find_lcm_gen(), "-c", source], cwd=tmp_path, check=True)
    flags = [f"-I{tmp_path}", *(one for one in compiler_flags() if not one.startswith("-std"))]
    program = tmp_path / "doubler"
    made = [_NODE.with_name("doubler.c"), *tmp_path.glob("*.c")]
    subprocess.run([compiler, "-o", program, *made, *flags], check=True)
    log = written(tmp_path / "c.lcmlog", inputs(topic="IN") + outputs(topic="OUT"))
    done = cli("bag", "rerun", log, "--json", "--", str(program))
    report = json.loads(done.out)
    assert (done.code, report["lockstep"], topic(report, "OUT")["matched"]) == (0, False, _COUNT)


def test_a_launch_file_is_run_and_chains_are_exact(tmp_path, cli):
    launch = tmp_path / "chain.yaml"
    python, node = shlex.quote(sys.executable), shlex.quote(str(_NODE))
    nodes = [
        {"name": name, "exec": python, "args": f"{node} __name:={name} {words}"}
        for name, words in (("first", "out:=middle"), ("second", "in:=middle _gain:=1.0"))
    ]
    launch.write_text(json.dumps({"nodes": nodes}))
    middle = outputs(topic="/middle")
    log = written(tmp_path / "l.lcmlog", inputs() + middle + outputs())
    done = cli("bag", "rerun", log, "--json", "--twice", "--launch", str(launch))
    report = json.loads(done.out)
    assert (done.code, report["inputs"]) == (0, _COUNT), report
    assert {one["topic"]: one["matched"] for one in report["topics"]} == {
        "/middle": _COUNT,
        "/out": _COUNT,
    }


def odometry(n):
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nsec = divmod(_START + n * _STEP, 10**9)
    message.twist.twist.linear.x = 0.3 * (1 - 0.9**n)
    return message.encode()


def desired(n):
    twist = Twist()
    twist.linear.x, twist.angular.z = 0.3 + 0.1 * (n % 2), 0.2
    return twist.encode()


def scan(n):
    return LaserScan(
        angle_min=-1.0, angle_increment=1.0, range_max=9.0, ranges=[n + 1.0] * 3
    ).encode()


_LABS = {
    "simple_controller": ({"/odometry": odometry, "/desired_velocity": desired}, ""),
    "moving_robot": ({}, ""),
    "reading_laser": ({"/dolly/laser_scan": scan}, "/rosout"),
    "listener": ({"/chatter": lambda n: String(data=str(n)).encode()}, "/rosout"),
}
"""The labs' nodes with what they subscribe to, and the output that they do not announce."""


def drive(path, topics):
    """Write a log of inputs."""
    times = [(n, _START + n * _STEP) for n in range(100)]
    packets = [
        Packet(topic, make(n), time)
        for topic, make in {**topics, "/else": desired}.items()
        for n, time in times
    ]
    return written(path, packets)


@pytest.mark.parametrize("name", _LABS)
def test_the_nodes_of_the_labs_say_the_same_again(name, tmp_path, cli):
    topics, output = _LABS[name]
    inputs, saved = drive(tmp_path / "inputs.lcmlog", topics), str(tmp_path / "saved.lcmlog")
    options = ("--json", *(("--output", output) if output else ()))
    program = ("--", "lcmtools", "run", name)
    assert cli("bag", "rerun", inputs, *options, "--save", saved, *program).code == 1
    done = cli("bag", "rerun", saved, *options, "--twice", *program)
    report = json.loads(done.out)
    assert (done.code, report["lockstep"]) == (0, True), report
    assert sum(one["matched"] for one in report["topics"]) >= 3


def test_a_gain_of_a_lab_that_is_changed_by_a_percent_is_found(tmp_path, cli):
    log, saved = drive(tmp_path / "i.lcmlog", _LABS["simple_controller"][0]), tmp_path / "s.lcmlog"
    program = ("--", "lcmtools", "run", "simple_controller")
    cli("bag", "rerun", log, "--save", str(saved), *program)
    done = cli("bag", "rerun", str(saved), *program, "_kp:=1.01")
    assert_says(done.out, "differing fields: effort[", "different")


class Doubled(Node):
    """A node for this process."""

    def __init__(self):
        super().__init__("doubled")
        self._out = self.create_publisher(Float64, "out")
        self.create_subscription(Float64, "in", self._double)

    def _double(self, message):
        self._out.publish(Float64(data=2 * message.data))


def test_a_class_of_nodes_is_tested_in_this_process(log):
    result = lcmtools.bag.rerun(log, Doubled, twice=True)
    assert result, result
    assert not lcmtools.bag.rerun(log, Doubled, arguments=["out:=other"])


def test_inputs_can_be_changed(log):
    def late(one):
        if one.message.data == 7:
            return None
        return one._replace(time=one.time + 10 * _STEP) if one.message.data == 9 else one

    result = lcmtools.bag.rerun(log, Doubled, inputs=late)
    (found,) = result.topics
    assert (found.now, len(found.missing)) == (_COUNT - 1, 1)
    result = lcmtools.bag.rerun(log, Doubled, inputs={"/in": "m.data > 10"})
    assert result.topics[0].now == _COUNT - 10


def test_a_saved_rerun_is_the_same_each_time_and_a_new_reference(log, tmp_path, cli):
    program = ("--", sys.executable, str(_NODE), "_gain:=3.0")
    saved = [tmp_path / name for name in ("a.lcmlog", "b.lcmlog")]
    for path in saved:
        assert cli("bag", "rerun", log, "--save", str(path), *program).code == 1
    assert saved[0].read_bytes() == saved[1].read_bytes()
    with lcmtools.bag.open(saved[0]) as opened:
        assert {one.name: one.messages for one in opened.topics.values()} == {
            "/in": _COUNT,
            "/out": _COUNT,
            "/recorded/out": _COUNT,
        }
    done = cli("bag", "rerun", str(saved[0]), "--save", str(tmp_path / "c.lcmlog"), *program)
    assert done.code == 0
    assert len(lcmtools.bag.open(tmp_path / "c.lcmlog").topics) == 3


def test_a_report_is_written_as_junit_and_as_a_picture(log, tmp_path, cli):
    pytest.importorskip("matplotlib")
    xml, picture = tmp_path / "r.xml", tmp_path / "p.png"
    words = ("--junit", str(xml), "--plot", str(picture))
    cli("bag", "rerun", log, *words, "--", sys.executable, str(_NODE), "_gain:=3.0")
    suite = ET.parse(xml).getroot()[0]  # noqa: S314 - our own
    assert (suite.get("tests"), suite.get("failures")) == ("2", "1")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_tolerances_come_from_a_contract(rerun, tmp_path):
    contract = tmp_path / "contract.yaml"
    contract.write_text("topics:\n  /out:\n    min_rate: 1\n    fields: {data: 2%}\n")
    assert rerun("_gain:=2.02", options=("--against", str(contract)))[0] == 0
    assert rerun("_gain:=2.1", options=("--against", str(contract)))[0] == 1


def test_a_log_that_is_cut_or_goes_back_in_time_is_played_and_noted(rerun, log, tmp_path):
    cut = tmp_path / "cut.lcmlog"
    cut.write_bytes(Path(log).read_bytes()[:-30])
    code, report = rerun(log=str(cut))
    assert (code, topic(report)["missing"]) == (1, [])
    assert (len(topic(report)["extra"]), len(report["notes"])) == (1, 1)
    with LogWriter(tmp_path / "back.lcmlog") as writer:
        for packet in [*sorted(inputs() + outputs(), key=lambda one: one.time)] * 2:
            writer.add(packet)
    code, report = rerun("_gain:=2.0", log=str(tmp_path / "back.lcmlog"))
    assert (code, topic(report)["matched"]) == (0, 2 * _COUNT)
    assert_says(report["notes"][0], "go back")


def test_a_log_that_cannot_be_used_is_refused(log, tmp_path, cli):
    (tmp_path / "empty.lcmlog").touch()
    program = ("--", sys.executable, str(_NODE))
    assert_says(cli("bag", "rerun", str(tmp_path / "empty.lcmlog"), *program).err, "it is empty")
    done = cli("bag", "rerun", log, "--input", "/inn", *program)
    assert_says(done.err, "there is no topic /inn in the log; did you mean /in?")
    done = cli("bag", "rerun", log, "--", "./nothere")
    assert_says(done.err, "cannot start ./nothere: No such file or directory")
    with pytest.raises(UsageError):
        lcmtools.bag.rerun(log, Float64)


def test_another_version_of_a_type_is_noted(rerun, tmp_path):
    other = [one._replace(payload=Twist().encode()) for one in inputs()]
    code, report = rerun(log=written(tmp_path / "o.lcmlog", other + outputs()))
    assert (code, len(topic(report)["missing"])) == (1, _COUNT)
    assert_says(report["notes"][0], "/in has geometry_msgs/Twist in the log")


@pytest.mark.parametrize("is_played", [False, True], ids=["at-its-start", "while-played-to"])
def test_ctrl_c_leaves_no_process(log, start, lcmtools_path, tmp_path, *, is_played):
    pid, hangs = tmp_path / "pid", tmp_path / "hangs"
    node = shlex.join([sys.executable, str(_NODE), "_hang_at:=5"])
    line = f"echo $$ > '{pid}.new'; mv '{pid}.new' '{pid}'; exec {node}"
    words = ("bag", "rerun", log, "--timeout", "60s", "--", "sh", "-c", line)
    runner = start(lcmtools_path, *words, MARK=str(hangs))
    while not (hangs if is_played else pid).exists():
        assert runner._process.poll() is None
    runner.send_signal(signal.SIGINT)
    assert runner.wait() == 130
    assert is_gone(int(pid.read_text()))


@pytest.mark.parametrize("is_given", [True, False])
def test_a_stranger_cannot_connect_to_the_bus(is_given):
    with PrivateBus() as bus:
        port = bus.url.rpartition(":")[2]
        text = f"import socket; print(socket.create_connection(('127.0.0.1', {port})).recv(8))"
        words, given = [sys.executable, "-c", text], {"LCM_DEFAULT_URL": bus.url}
        with subprocess.Popen(words, stdout=subprocess.PIPE, env=given if is_given else {}) as one:
            while one.poll() is None:
                bus.turn(0.05)
            assert (one.stdout.read() != b"b''\n", bus.count) == (is_given, int(is_given))
