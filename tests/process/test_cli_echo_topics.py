"""echo of several topics, patterns and types, on a bus where they come and go."""

import csv
import json
import sys

import pytest
import yaml
from fixtures.says import assert_line, assert_says

pytestmark = pytest.mark.usefixtures("use_module_bus", "fleet")

# Two robots of a node that announces its types, and channels of a program that does not.
_FLEET = """
import time
import lcm
import lcmtools
from lcmtools.types.geometry_msgs import Point, PointStamped
from lcmtools.types.std_msgs import Header, Int32, String

lcmtools.init()
node = lcmtools.Node("fleet")
point = PointStamped()
point.point.x = 1.5
point.header.frame_id = "odom"
where = {f"/husky{n}/where": node.create_publisher(PointStamped, f"/husky{n}/where") for n in "01"}
names = node.create_publisher(String, "/husky1/name")
name = String()
name.data = "one"
bus = lcm.LCM()
number = Int32()
print("ready", flush=True)
while True:
    for publisher in where.values():
        publisher.publish(point)
    names.publish(name)
    bus.publish("A*B", name.encode())
    bus.publish("AXB", name.encode())
    bus.publish("A[0]C", name.encode())
    bus.publish("NOISY1", bytes(range(12)))
    bus.publish("MIXED", (number if number.data % 2 else name).encode())
    bus.publish("POINT", Point().encode())
    number.data += 1
    time.sleep(0.02)
"""

_LATER = """
import time
import lcm
from lcmtools.types.std_msgs import Int32

bus = lcm.LCM()
while True:
    bus.publish("/later/number", Int32().encode())
    time.sleep(0.02)
"""


@pytest.fixture(scope="module")
def fleet(module_start, tmp_path_factory):
    """The robots, publishing."""
    script = tmp_path_factory.mktemp("fleet") / "fleet.py"
    script.write_text(_FLEET)
    module_start(sys.executable, str(script)).wait_for("ready")


def output(result):
    assert (result.code, result.err) == (0, "")
    return result.out


def test_a_pattern_shows_each_message_under_its_topic(cli):
    shown = output(cli("echo", "/husky*/where", "--field", "point.x", "-n", "20"))
    assert set(shown.split("---\n")) == {"# /husky0/where\n1.5\n", "# /husky1/where\n1.5\n", ""}
    assert [document for document in yaml.safe_load_all(shown) if document] == [1.5] * 20


def test_a_pattern_may_have_a_field_path_behind_it(cli):
    lines = output(cli("echo", "husky?/where.point/x", "-n", "20", "--json")).splitlines()
    assert {json.loads(line)["topic"] for line in lines} == {"/husky0/where", "/husky1/where"}
    assert {json.loads(line)["message"] for line in lines} == {1.5}


def test_several_topics_may_be_named(cli):
    shown = output(cli("echo", "husky1/name/data", "/husky0/where/point/x", "-n", "20"))
    assert set(shown.split("---\n")) == {'# /husky1/name\n"one"\n', "# /husky0/where\n1.5\n", ""}


def test_csv_of_several_topics_has_a_column_for_them(cli):
    head, *rows = csv.reader(
        output(cli("echo", "/husky*/where/point", "-p", "-n", "20")).splitlines()
    )
    assert head == ["%time", "topic", "field.x", "field.y", "field.z"]
    assert {tuple(row) for row in rows} == {
        ("0", "/husky0/where", "1.5", "0.0", "0.0"),
        ("0", "/husky1/where", "1.5", "0.0", "0.0"),
    }


def test_topics_without_the_field_are_passed_over_and_that_is_said_once(cli):
    result = cli("echo", "/husky1/*", "--field", "header.frame_id", "-n", "20")
    assert set(result.out.split("---\n")) == {'# /husky1/where\n"odom"\n', ""}
    parts = ("/husky1/name", "left out", "std_msgs/String", "'header'", "fields: data")
    assert_line(result.err, "lcmtools echo: ", *parts)


def test_two_stars_match_all_topics_but_hidden_ones(cli):
    lines = output(cli("echo", "**", "-n", "100", "--raw", "--json")).splitlines()
    assert {json.loads(line)["topic"] for line in lines} == {
        *("/husky0/where", "/husky1/where", "/husky1/name", "A*B", "AXB", "A[0]C", "NOISY1"),
        *("MIXED", "POINT"),
    }


def test_one_star_stays_within_a_part_of_the_name(cli):
    lines = output(cli("echo", "*", "-n", "50", "--raw", "--json")).splitlines()
    topics = {json.loads(line)["topic"] for line in lines}
    assert topics == {"A*B", "AXB", "A[0]C", "NOISY1", "MIXED", "POINT"}


def test_a_channel_that_has_a_star_in_its_name_can_be_reached(cli):
    assert output(cli("echo", "A*B", "-n", "5")) == 'data: "one"\n---\n' * 5


def test_a_channel_that_has_brackets_in_its_name_can_be_reached(cli):
    assert output(cli("echo", "A[0]C", "-1")) == 'data: "one"\n---\n'
    assert output(cli("echo", "A[0]C.data", "-1")) == '"one"\n---\n'


def test_payloads_of_no_known_type_say_their_topic_too(cli):
    assert cli("echo", "NOIS*", "-1").out.splitlines()[:2] == [
        "# NOISY1",
        "# unknown type, fingerprint 0x0001020304050607",
    ]
    record = json.loads(output(cli("echo", "NOIS*", "-1", "--json")))
    assert list(record) == ["topic", "bytes", "error", "data"]
    assert output(cli("echo", "NOIS*", "-1", "--raw")) == ("# NOISY1\n000102030405060708090a0b\n")


@pytest.mark.parametrize("command", ["echo", "bag record"])
def test_one_of_several_topics_is_named_while_nothing_comes_on_it(
    command, start, lcmtools_path, module_bus_url, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    words = *command.split(), "/husky1/name", "/husky1/nam"
    process = start(lcmtools_path, *words, LCM_DEFAULT_URL=module_bus_url)
    line = f"lcmtools {command}: no message on /husky1/nam yet; did you mean /husky1/name?"
    assert process.wait_for("no message") == line


def test_a_topic_that_a_log_has_only_announced_is_told_from_what_it_has(cli, tmp_path):
    log = str(tmp_path / "a.lcmlog")
    cli("bag", "record", "/husky0/where", "-n", "1", "-o", log)
    result = cli("echo", "-b", log, "/husky0/where", "/husky1/where")
    assert result.code == 0
    line = "lcmtools echo: the log has no message on /husky1/where; did you mean /husky0/where?\n"
    assert result.err == line


def test_topics_that_come_later_are_taken_too(start, lcmtools_path, tmp_path, module_bus_url):
    later = tmp_path / "later.py"
    later.write_text(_LATER)
    echo = start(lcmtools_path, "echo", "/later/*", "-1", LCM_DEFAULT_URL=module_bus_url)
    line = echo.wait_for("no message")
    assert_says(line, "lcmtools echo: ", "no message", "/later/*", "; on the bus: ")
    start(sys.executable, str(later), LCM_DEFAULT_URL=module_bus_url)
    assert echo.wait() == 0
    assert echo.lines[-3:] == ["# /later/number", "data: 0", "---"]


def test_a_pattern_is_announced_as_a_subscription_to_what_it_matches(
    start, lcmtools_path, cli, module_bus_url
):
    echo = start(lcmtools_path, "echo", "/husky*/where", LCM_DEFAULT_URL=module_bus_url)
    echo.wait_for("# /husky1/where")
    for topic in ("/husky0/where", "/husky1/where"):
        assert f"/_lcmtools_echo_{echo.pid}" in cli("info", topic).out


def test_nothing_within_the_timeout_names_all_that_was_waited_for(cli):
    result = cli("echo", "/nope/*", "/nothing", "--timeout", "300ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, "lcmtools echo: ", "/nope/*, /nothing", "0.3 s; on the bus: ")


def test_messages_of_two_types_on_one_topic_are_both_shown(cli):
    documents = output(cli("echo", "MIXED", "-n", "10")).split("---\n")
    assert {'data: "one"\n'} < set(documents)
    assert {type(document["data"]) for document in map(yaml.safe_load, documents[:10])} == {
        str,
        int,
    }


def test_csv_keeps_to_the_type_of_the_first_message(cli):
    result = cli("echo", "MIXED", "-p", "-n", "5")
    _, *rows = csv.reader(result.out.splitlines())
    is_number = rows[0][1].isdigit()
    assert [row[1].isdigit() for row in rows] == [is_number] * 5
    kept, left = ("Int32", "String") if is_number else ("String", "Int32")
    parts = (f"std_msgs/{left}", "left out", f"std_msgs/{kept}")
    assert_line(result.err, "lcmtools echo: ", *parts)


def test_the_type_that_is_said_settles_which_of_two_equal_types_is_meant(cli):
    nested = output(cli("echo", "POINT", "geometry_msgs/msg/Point", "-1", "--json"))
    assert json.loads(nested) == {"x": 0.0, "y": 0.0, "z": 0.0}
    shown = output(cli("echo", "POINT", "std_msgs/Int32", "-1")).splitlines()
    assert_says(shown[0], "# ", "not std_msgs/Int32", "geometry_msgs/Point")


def test_the_type_that_is_said_tells_wrong_fields_before_a_message_comes(cli):
    result = cli("echo", "/nobody", "geometry_msgs/Point", "--field", "w")
    assert (result.code, result.out) == (2, "")
    parts = ("geometry_msgs/Point", "no field 'w'", "fields: x, y, z")
    assert_line(result.err, "lcmtools echo: ", *parts)
