"""hz, bw and delay where a simulator keeps the time: it runs at its own pace, and starts again."""

import pytest
from fixtures.says import assert_says

# Ten messages a simulated second, five times as fast as that; stamped 0.3 s in the past.
_SIMULATOR = """
import sys
import time
import lcm
from lcmtools.types.geometry_msgs import PoseStamped
from lcmtools.types.rosgraph_msgs import Clock

bus = lcm.LCM()
clock, pose = Clock(), PoseStamped()
steps = int(sys.argv[1])
step = 0
while True:
    step = step % steps + 1
    clock.clock.sec, clock.clock.nsec = divmod(step * 100_000_000, 1_000_000_000)
    stamp = max(1, step * 100_000_000 - 300_000_000)
    pose.header.stamp.sec, pose.header.stamp.nsec = divmod(stamp, 1_000_000_000)
    bus.publish("/clock", clock.encode())
    bus.publish("/pose", pose.encode())
    print("sent", flush=True)
    time.sleep(0.02)
"""


@pytest.fixture
def simulate(start_python, bus_url, monkeypatch):
    """``simulate(steps)``: a simulator that starts again after so many steps."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)

    def run(steps):
        start_python(_SIMULATOR, str(steps)).wait_for("sent")

    return run


def test_hz_goes_by_simulated_time(simulate, cli):
    simulate(100_000)
    result = cli("hz", "/pose", "-n", "1")
    assert result.out.startswith(
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: "
    )
    subscribed, note = result.err.splitlines()
    assert subscribed == "subscribed to [/pose]"
    assert_says(note, "lcmtools hz: ", "simulated", "/clock; --wall-time")


def test_hz_wall_time_goes_by_real_time(simulate, cli):
    simulate(100_000)
    result = cli("hz", "/pose", "-n", "1", "--wall-time")
    assert float(result.out.split()[2]) == pytest.approx(45, abs=15)
    assert result.err == "subscribed to [/pose]\n"


def test_delay_of_simulated_stamps_is_simulated(simulate, cli):
    simulate(100_000)
    result = cli("delay", "/pose", "-n", "1", "-w", "5")
    assert result.out.startswith("average delay: 0.300\n\tmin: 0.300s max: 0.300s")


def test_time_that_goes_back_is_said_and_counted_anew(simulate, start, lcmtools_path):
    simulate(80)
    hz = start(lcmtools_path, "hz", "/pose")
    hz.wait_for("time has reset, resetting counters")
    while not (line := hz.wait_for("")).startswith("average rate"):
        pass
    assert line == "average rate: 10.000"
    assert hz.wait_for("min: ").startswith("\tmin: 0.100s max: 0.100s")


def test_hz_and_echo_get_the_time_of_each_message(start, lcmtools_path, bus_url, cli, monkeypatch):
    """The simulator tells the time seldom unless somebody says that he listens to it."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    start(lcmtools_path, "run", "sim", "husky").wait_for("simulating")
    reports = cli("hz", "/husky0/imu", "-n", "3", "-w", "20").out.splitlines()
    # 50 Hz by steps of 1/240 s: four or five of them.
    assert reports[-1].startswith("\tmin: 0.017s max: 0.021s")
    rows = cli("echo", "-p", "/tf", "-n", "60").out.splitlines()
    times = [int(row.split(",")[0]) for row in rows[-20:]]
    assert len(set(times)) == 20
