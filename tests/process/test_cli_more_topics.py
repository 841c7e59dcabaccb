"""find, bw, delay and hz of several topics, on a bus with nodes and a plain program."""

import json
import re
import signal
import sys
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import String

# Knows no nodes. It sends a point, which is a vector to LCM; a pose stamped 0.25 s ago; noise.
_PLAIN = """
import time
import lcm
from lcmtools.types.geometry_msgs import Point, PoseStamped

bus = lcm.LCM()
stamped = PoseStamped()
while True:
    then = time.time_ns() - 250_000_000
    stamped.header.stamp.sec, stamped.header.stamp.nsec = divmod(then, 1_000_000_000)
    bus.publish("POSE", stamped.encode())
    bus.publish("POINT", Point().encode())
    bus.publish("NOISE", bytes(range(200)))
    print("sent", flush=True)
    time.sleep(0.05)
"""

pytestmark = pytest.mark.usefixtures("use_module_bus", "programs")


@pytest.fixture(scope="module")
def programs(module_start, lcmtools_path, tmp_path_factory):
    """A listener, a publisher of "hello" at 20 Hz, and the plain program."""
    script = tmp_path_factory.mktemp("plain") / "plain.py"
    Path(script).write_text(_PLAIN)
    listener = module_start(lcmtools_path, "run", "listener")
    module_start(lcmtools_path, "pub", "-r", "20", "/chatter", "std_msgs/String", "hello")
    listener.wait_for("I heard: [hello")
    module_start(sys.executable, str(script)).wait_for("sent")


def size():
    """The bytes of a message on /chatter."""
    message = String()
    message.data = "hello"
    return len(encode(message))


def next_table(program, column):
    """The next table's cells by the first of each row, the header's too."""
    header = program.wait_for(column)
    assert set(program.wait_for("=")) == {"="}
    rows = [header, *(program.wait_for(topic) for topic in ("/chatter", "POINT", "/zzz"))]
    return {cells[0]: cells[1:] for cells in map(str.split, rows)}


@pytest.mark.parametrize(
    "name", ["std_msgs/String", "std_msgs/msg/String", "std_msgs.String", "String"]
)
def test_find_prints_the_topics_that_are_announced_with_a_type(name, cli):
    result = cli("find", name)
    assert (result.code, result.out, result.err) == (0, "/chatter\n", "")


@pytest.mark.parametrize("name", ["geometry_msgs/Point", "geometry_msgs/Vector3"])
def test_find_knows_plain_programs_by_every_type_of_their_fingerprint(name, cli):
    assert json.loads(cli("topic", "find", name, "--json").out) == ["POINT"]


def test_find_of_a_type_that_no_topic_has_says_so_on_standard_error(cli, module_bus_url):
    result = cli("find", "sensor_msgs/Image")
    assert (result.code, result.out) == (0, "")
    assert_line(result.err, "no topics", "sensor_msgs/Image", f"{module_bus_url}\n")


def test_find_of_an_unknown_type_is_exit_code_2_with_a_near_miss(cli):
    result = cli("find", "std_msgs/Strin")
    assert (result.code, result.out) == (2, "")
    hint = "; did you mean std_msgs/String?\n"
    assert_line(result.err, "lcmtools find: ", "'std_msgs/Strin'", hint)


def test_bw_prints_the_lines_of_rostopic(start, lcmtools_path):
    bw = start(lcmtools_path, "bw", "chatter")
    bw.wait_for("subscribed to [/chatter]")
    average = re.fullmatch(r"average: (\d+\.\d\d)B/s", bw.wait_for("average: "))
    assert average is not None
    assert float(average[1]) == pytest.approx(20 * size(), rel=0.5)
    assert re.fullmatch(
        rf"\tmean: {size()}\.00B min: {size()}\.00B max: {size()}\.00B window: \d+",
        bw.wait_for("mean: "),
    )


def test_bw_is_in_kilobytes_from_a_thousand_on(start, lcmtools_path):
    bw = start(lcmtools_path, "bw", "NOISE", "-w", "2")
    assert re.fullmatch(r"average: \d+\.\d\dKB/s", bw.wait_for("KB/s"))
    assert bw.wait_for("mean: ") == "\tmean: 0.20KB min: 0.20KB max: 0.20KB window: 2"


def test_bw_of_several_topics_is_a_table(start, lcmtools_path):
    bw = start(lcmtools_path, "bw", "/chatter", "POINT", "/zzz")
    rows = next_table(bw, "average")
    while "-" in (*rows["/chatter"], *rows["POINT"]):
        rows = next_table(bw, "average")  # the first may come before two messages
    assert rows["topic"] == ["average", "mean", "min", "max", "window"]
    assert rows["/chatter"][1:4] == [f"{size()}.00B"] * 3
    assert rows["POINT"][1:4] == ["32.00B"] * 3
    assert rows["/zzz"] == ["-"] * 5


def test_bw_json_is_an_object_a_line(start, lcmtools_path):
    bw = start(lcmtools_path, "bw", "--json", "NOISE")
    measured = json.loads(bw.wait_for("mean_bytes"))
    assert measured["bytes_per_second"] == pytest.approx(4000, rel=0.5)
    assert [measured[f"{name}_bytes"] for name in ("mean", "min", "max")] == [200] * 3


def test_delay_prints_the_lines_of_rostopic(start, lcmtools_path):
    delay = start(lcmtools_path, "delay", "POSE")
    mean = delay.wait_for("average delay: ").removeprefix("average delay: ")
    assert float(mean) == pytest.approx(0.25, abs=0.05)
    assert re.fullmatch(
        r"\tmin: 0\.\d{3}s max: 0\.\d{3}s std dev: 0\.\d{5}s window: \d+", delay.wait_for("min: ")
    )


def test_delay_of_several_topics_is_a_table(start, lcmtools_path):
    delay = start(lcmtools_path, "delay", "POSE", "/zzz")
    assert delay.wait_for("std_dev").split()[:2] == ["topic", "delay"]
    assert float(delay.wait_for("POSE ").split()[1]) == pytest.approx(0.25, abs=0.05)
    assert delay.wait_for("/zzz").split() == ["/zzz", *"-----"]


@pytest.mark.parametrize(
    ("verb", "topic", "first"),
    [
        ("bw", "POINT", "average: "),
        ("delay", "POSE", "average delay: "),
        ("hz", "POINT", "average"),
    ],
)
def test_so_many_reports_are_enough(verb, topic, first, cli):
    result = cli(verb, topic, "-n", "2")
    lines = result.out.splitlines()
    assert result.code == 0
    assert [line.startswith(first) for line in lines] == [True, False] * 2


def test_hz_counts_what_a_filter_lets_through(cli):
    result = cli("hz", "/chatter", "--filter", "m.data == 'hello'", "-n", "1")
    assert float(result.out.split()[2]) == pytest.approx(20, abs=5)
    none = cli("hz", "/chatter", "--filter", "data == 'x'", "--timeout", "300ms")
    assert none.code == 4
    assert_says(none.err, "lcmtools hz: ", "/chatter", "data == 'x'", "within 0.3 s")


def test_hz_finds_a_filters_unknown_field_before_a_message_has_come(cli):
    result = cli("hz", "/chatter", "--filter", "dota == 'x'")
    assert (result.code, result.out) == (2, "")
    parts = ("std_msgs/String", "'dota'", "fields: data", "; did you mean data?\n")
    assert_line(result.err, "lcmtools hz: ", *parts)


def test_find_c_is_how_many_topics_there_are(cli):
    assert cli("find", "-c", "String").out == "1\n"


def test_info_shows_what_was_seen_of_a_program_that_is_no_node(cli):
    lines = cli("info", "POINT").out.splitlines()
    row = next(row for row, line in enumerate(lines) if "plain.py (pid " in line)
    assert re.fullmatch(
        r"     seen messages: \d+, bytes: \d+, rate: \d+\.\d\d Hz, last: \d\.\d s ago",
        lines[row + 1],
    )


def test_delay_json_is_an_object_a_line(start, lcmtools_path):
    measured = json.loads(start(lcmtools_path, "delay", "POSE", "--json").wait_for('"delay"'))
    assert 0.24 <= measured["min"] <= measured["delay"] <= measured["max"]


def test_delay_of_a_type_without_a_header_is_one_error_with_exit_code_1(cli):
    result = cli("delay", "/chatter")
    assert (result.code, result.out) == (1, "")
    subscribed, error = result.err.splitlines()
    assert subscribed == "subscribed to [/chatter]"
    parts = (
        "std_msgs/String",
        "/chatter",
        "no header",
        "utime",
        "; lcmtools msg find-field header",
    )
    assert_says(error, "lcmtools delay: ", *parts)


def test_delay_ends_where_no_stamp_is_a_time(start, cli, lcmtools_path):
    start(lcmtools_path, "pub", "-v", "-r", "20", "/zero", "geometry_msgs/PoseStamped").wait_for(
        "publishing #1"
    )
    result = cli("delay", "/zero", "--timeout", "1s")
    assert result.code == 4
    assert_says(result.err, "stamp", "/zero", "0")


def test_delay_of_an_unknown_type_is_one_error_with_exit_code_1(cli):
    result = cli("delay", "NOISE")
    assert (result.code, result.out) == (1, "")
    _, _, error = result.err.partition("\n")
    parts = "type", "NOISE", "is not known: unknown type", "lcmtools echo NOISE"
    assert_line(error, "lcmtools delay: ", *parts)


def test_hz_of_several_topics_is_rostopics_table(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "/chatter", "POINT", "/zzz", "-w", "5")
    rows = next_table(hz, "min_delta")
    while [rows[topic][-1] for topic in ("/chatter", "POINT")] != ["5", "5"]:
        rows = next_table(hz, "min_delta")  # the first may come before five messages
    assert rows["topic"] == ["rate", "min_delta", "max_delta", "std_dev", "window"]
    assert rows["/zzz"] == ["-"] * 5
    for topic in ("/chatter", "POINT"):
        rate, shortest, longest, deviation = map(float, rows[topic][:4])
        assert 0.999 * shortest <= 1 / rate <= 1.001 * longest  # of four digits
        assert deviation <= longest - shortest + 1e-5


def test_hz_tells_which_of_several_topics_is_silent(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "/chatter", "/POINTS")
    line = hz.wait_for("no message on")
    assert_says(line, "lcmtools hz: ", "no message", "/POINTS", "; did you mean POINT?")


def test_hz_measures_a_topic_under_two_spellings_twice(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "--json", "chatter", "/chatter")
    measured = [json.loads(hz.wait_for('"rate"')) for _ in range(2)]
    assert [one["topic"] for one in measured] == ["chatter", "/chatter"]
    assert measured[0]["rate"] == measured[1]["rate"]


@pytest.mark.parametrize("verb", ["bw", "delay", "hz"])
def test_nothing_within_the_timeout_is_exit_code_4(verb, cli):
    result = cli(verb, "/zzz", "--timeout", "200ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, f"lcmtools {verb}: ", "/zzz", "within 0.2 s")


def test_timeout_of_several_topics_is_about_all_of_them(cli):
    result = cli("hz", "/zzz", "/yyy", "--timeout", "200ms")
    assert result.code == 4
    assert_says(result.err, "/zzz, /yyy", "within 0.2 s")


@pytest.mark.parametrize(
    ("verb", "topic", "first"),
    [
        ("bw", "POINT", "average: "),
        ("delay", "POSE", "average delay: "),
        ("hz", "POINT", "average"),
    ],
)
def test_ctrl_c_prints_what_was_measured_and_is_exit_code_130(
    verb, topic, first, start, lcmtools_path
):
    command = start(lcmtools_path, verb, topic)
    command.wait_for(first)
    command.wait_for("window: ")
    echo = start(lcmtools_path, "echo", "-n", "2", topic)
    assert echo.wait() == 0  # so two messages have come since
    command.send_signal(signal.SIGINT)
    assert command.wait() == 130
    assert command.output.count(first) >= 2
    assert "Traceback" not in command.output
