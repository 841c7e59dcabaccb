"""Commands that look, on a log file in place of a bus."""

import lcm
import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.messages.codec import encode
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.std_msgs import String

MESSAGES = 30
PERIOD_US = 10_000


@pytest.fixture
def log(tmp_path):
    """The path of a log with 30 messages at 100 Hz on /chatter."""
    path = str(tmp_path / "a.log")
    log = lcm.EventLog(path, "w", overwrite=True)
    for number in range(MESSAGES):
        message = String()
        message.data = f"message {number}"
        log.write_event(1_000_000 + number * PERIOD_US, "/chatter", encode(message))
    log.close()
    return path


@pytest.mark.parametrize("speed", ["1", "0"])
def test_echo_prints_all_of_a_log_and_ends_with_it(speed, log, cli):
    result = cli("echo", "chatter", "--lcm-url", f"file://{log}?speed={speed}")
    expected = "".join(f'data: "message {number}"\n---\n' for number in range(MESSAGES))
    assert (result.code, result.out, result.err) == (0, expected, "")


def test_hz_measures_a_log_and_ends_with_it(log, cli):
    result = cli("hz", "chatter", "--lcm-url", f"file://{log}")
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        f"average rate: 100.000\n\tmin: 0.010s max: 0.010s std dev: 0.00000s window: {MESSAGES}\n"
    )


def test_bw_measures_a_log_by_its_own_times(log, cli):
    result = cli("bw", "chatter", "--lcm-url", f"file://{log}")
    assert (result.code, result.err) == (0, "")
    average = float(result.out.split()[1].removesuffix("KB/s"))
    assert average == pytest.approx(2.3, abs=0.2)  # 22 or 23 bytes at 100 Hz


@pytest.mark.parametrize("pattern", ["/chat*", "**", "c?atter"])
@pytest.mark.parametrize("verb", ["hz", "bw", "type", "info"])
def test_a_pattern_means_all_topics_that_match(verb, pattern, log, cli):
    result = cli(verb, pattern, "--json", "--lcm-url", f"file://{log}")
    assert (result.code, '"/chatter"' in result.out) == (0, True)


@pytest.mark.parametrize(("verb", "noun"), [("hz", "rate"), ("bw", "bandwidth")])
def test_one_message_in_a_log_is_said_to_be_too_few(verb, noun, tmp_path, cli):
    path = str(tmp_path / "one.log")
    log = lcm.EventLog(path, "w", overwrite=True)
    log.write_event(1, "/chatter", encode(String()))
    log.close()
    result = cli(verb, "chatter", "--lcm-url", f"file://{path}")
    assert (result.code, result.out) == (0, "")
    assert_line(result.err, f"lcmtools {verb}: ", "one message", "chatter", noun, "two")


@pytest.mark.parametrize("verb", ["hz", "bw", "delay"])
def test_topic_that_a_log_does_not_have_is_exit_code_1(verb, log, cli):
    result = cli(verb, "chater", "--lcm-url", f"file://{log}")
    assert (result.code, result.out) == (1, "")
    parts = ("log", "no message", "chater; did you mean /chatter?")
    assert_line(result.err, f"lcmtools {verb}: ", *parts)


def test_list_hz_of_a_log_is_exact(log, cli):
    result = cli("list", "--hz", "--lcm-url", f"file://{log}")
    assert result.out == "/chatter  100.00 Hz\n"


@pytest.mark.parametrize("wait", [[], ["--wait", "2s"]])
def test_list_shows_what_is_in_a_log(wait, log, cli):
    result = cli("list", "-t", *wait, "--lcm-url", f"file://{log}?speed=0")
    assert (result.code, result.err) == (0, "")
    assert result.out == "/chatter [std_msgs/String]\n"


def test_wtf_looks_into_a_log(log, cli):
    result = cli("wtf", "--lcm-url", f"file://{log}?speed=0")
    assert (result.code, result.out) == (0, "No errors or warnings\n")


def test_info_says_that_a_log_does_not_tell_senders(log, cli):
    result = cli("info", "/chatter", "--lcm-url", f"file://{log}?speed=0")
    assert_says(result.out, " * a plain LCM program (", "not identify")


def test_delays_in_a_log_of_a_simulator_are_by_its_clock(tmp_path, cli):
    path = str(tmp_path / "sim.log")
    log = lcm.EventLog(path, "w", overwrite=True)
    for number in range(20):
        clock, odometry = Clock(), Odometry()
        clock.clock.sec, clock.clock.nsec = 5, 20_000_000 * (number + 1)
        odometry.header.stamp.sec, odometry.header.stamp.nsec = 5, 20_000_000 * number
        time = 1_700_000_000_000_000 + number * 20_000
        log.write_event(time, "/clock", encode(clock))
        log.write_event(time + 1, "/odometry", encode(odometry))
    log.close()
    result = cli("delay", "-b", path, "/odometry")
    assert result.code == 0, result.err
    assert result.out.startswith("average delay: 0.020\n")
