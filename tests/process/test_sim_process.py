"""The simulator as a process: it computes subscribed topics, keeps its time, and leaves nothing."""

import json
import os
import signal
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("on_bus")

pytest.importorskip("pybullet")


WORLD = """\
node: yard
robots:
  - model: pioneer
    namespace: /
    sensors: [{type: depth_camera, topic: camera, width: 32, height: 24}]
"""
DEPTH = "/camera/depth/image_raw"
FOR_VIEWERS = "/yard/world", "/yard/poses"
"""For nodes that subscribe to them alone."""

# Subscribes to one topic, as any LCM program does, without an announcement.
PLAIN_LISTENER = """
import lcm

bus = lcm.LCM()
bus.subscribe("/camera/depth/image", lambda channel, data: None)
print("listening", flush=True)
while True:
    bus.handle()
"""

# The same in a process that is a node too, and announces its subscriptions as one.
PLAIN_LISTENER_IN_A_NODE = f"""
import lcmtools

lcmtools.init([])
node = lcmtools.Node("both")
{PLAIN_LISTENER}
"""


@pytest.fixture
def simulate(start, lcmtools_path, tmp_path):
    """Starts the simulator with a Pioneer whose camera is small."""

    def run(*arguments):
        world = tmp_path / "yard.yaml"
        world.write_text(WORLD)
        program = start(lcmtools_path, "run", "sim", str(world), *arguments)
        program.wait_for("simulating")
        return program

    return run


@pytest.fixture
def published(cli):
    """The number of messages that the simulator has published on each topic."""

    def count():
        (described,) = json.loads(cli("node", "info", "/yard", "--json").out)
        return {entry["topic"]: entry["messages"] for entry in described["publications"]}

    return count


def test_only_topics_with_subscribers_are_computed(
    simulate, start, lcmtools_path, published, wait_until
):
    simulate()
    wait_until(lambda: published()["/clock"] > 10)
    before = published()
    assert {topic for topic, count in before.items() if count} == {"/clock", "/rosout"}

    start(lcmtools_path, "run", "listener", f"chatter:={DEPTH}").wait_for("ignored")

    wait_until(lambda: published()[DEPTH] > 5)
    after = published()
    assert {topic for topic, count in after.items() if count} == {"/clock", "/rosout", DEPTH}


def test_a_command_that_looks_counts_as_a_listener_as_long_as_it_looks(
    simulate, cli, published, wait_until
):
    simulate()
    result = cli("hz", DEPTH, "-n", "1")
    assert result.out.startswith("average rate: ")
    assert published()[DEPTH] > 5

    def is_settled():
        """Return whether no image is computed while time passes."""
        before = published()
        wait_until(lambda: published()["/clock"] > before["/clock"] + 20)
        return published()[DEPTH] == before[DEPTH]

    wait_until(is_settled)


@pytest.mark.parametrize(
    "program", [PLAIN_LISTENER, PLAIN_LISTENER_IN_A_NODE], ids=["no node", "a node besides"]
)
def test_for_a_plain_lcm_program_everything_is_computed(
    simulate, start_python, published, wait_until, program
):
    simulate()
    wait_until(lambda: published()["/clock"] > 10)
    plain = start_python(program)
    plain.wait_for("listening")

    others = {"/rosout", *FOR_VIEWERS}
    wait_until(lambda: all(count for topic, count in published().items() if topic not in others))
    assert all(published()[topic] == 0 for topic in FOR_VIEWERS)

    plain.end()
    wait_until(lambda: _stands_still(published))


def test_a_viewer_gets_the_world_at_once_and_a_new_one_when_a_robot_comes(
    simulate, start, cli, lcmtools_path
):
    simulate()
    viewer = start(lcmtools_path, "echo", "/yard/world", "--field", "markers[1].ns")
    viewer.wait_for("ground")

    assert cli("sim", "spawn", "dolly", "/dolly", "3", "0").code == 0
    viewer.wait_for("ground")

    poses = cli("echo", "/yard/poses", "-n", "1", "--json").out
    frames = [one["child_frame_id"] for one in json.loads(poses)["transforms"]]
    assert {"ground_truth/base_footprint", "ground_truth/dolly/base_footprint"} < {*frames}


@pytest.mark.parametrize("is_first", [True, False], ids=["before it", "after it"])
def test_subscribers_receive_each_requested_step(
    simulate, start_python, cli, published, *, is_first
):
    if is_first:
        start_python(PLAIN_LISTENER).wait_for("listening")
    simulate("--paused")
    if not is_first:
        start_python(PLAIN_LISTENER).wait_for("listening")

    assert cli("sim", "step", "240").code == 0

    counted = published()
    assert (counted["/clock"], counted["/RosAria/pose"], counted[DEPTH]) == (70, 10, 30)


def _stands_still(published):
    """Return whether no picture is published while the clock goes on."""
    first = published()
    if "/clock" not in first:  # the look was over before the simulator had answered
        return False
    deadline = time.monotonic() + 40
    while (second := published()).get("/clock", 0) < first["/clock"] + 50:
        assert time.monotonic() < deadline
    return first.get(DEPTH) == second.get(DEPTH)


@pytest.mark.parametrize("moment", ["at its start", "while it is paused"])
def test_killed_at_any_moment_it_leaves_no_process_and_is_stale(
    start, simulate, cli, lcmtools_path, wait_until, moment
):
    if moment == "at its start":
        program = start(lcmtools_path, "run", "sim")
    else:
        program = simulate("--paused")
    program.send_signal(signal.SIGKILL)

    assert program.wait() == -signal.SIGKILL
    wait_until(lambda: _members(program.pid) == [])
    listed = cli("node", "list")
    if moment != "at its start":
        assert "/yard" in listed.out
        assert "stale" in listed.out + listed.err
        assert "ended without saying goodbye" in cli("wtf").out


def _members(group):
    """The processes of a group that still run."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:  # gone in between
                continue
            if int(fields[2]) == group and fields[0] != "Z":
                found.append(int(entry.name))
    return found


def test_it_ends_after_its_duration_as_fast_as_it_can(simulate):
    program = simulate("--rate", "0", "--duration", "20")

    assert program.wait() == 0


def test_stopped_for_a_while_it_says_so_and_does_not_race_afterwards(simulate, cli):
    program = simulate()
    begun = time.monotonic()
    before = _simulated(cli)
    os.kill(program.pid, signal.SIGSTOP)
    time.sleep(3.0)  # the event is that time has passed
    os.kill(program.pid, signal.SIGCONT)
    program.wait_for("s were dropped")

    passed, real = _simulated(cli) - before, time.monotonic() - begun
    # A quarter of a second of the three is made good, no more.
    assert passed < real - 2.0


def _simulated(cli):
    answer = json.loads(cli("sim", "state", "/", "--json").out)
    return float(answer["time"]) / 1e9


def test_a_node_on_simulated_time_goes_and_stands_with_the_simulator(
    simulate, start, cli, lcmtools_path
):
    simulate("--paused")
    talker = start(lcmtools_path, "run", "talker", "_use_sim_time:=true")
    # Ten messages a simulated second; while nobody steps, none comes.
    deadline = time.monotonic() + 40
    while _hellos(talker) < 4:
        assert time.monotonic() < deadline, talker.output
        cli("sim", "step", "24")
    count = _hellos(talker)
    time.sleep(0.5)  # that nothing comes takes time to see
    assert _hellos(talker) == count

    cli("sim", "reset")
    cli("sim", "resume")
    deadline = time.monotonic() + 40
    while _hellos(talker) < count + 5:
        assert time.monotonic() < deadline, talker.output
        time.sleep(0.05)


def _hellos(talker):
    return sum("hello" in line for line in talker.lines)
