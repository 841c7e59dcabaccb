"""echo's field paths, filters and forms, on a bus with publishers of several types."""

import csv
import json
import sys

import pytest
from fixtures.says import assert_says

pytestmark = pytest.mark.usefixtures("use_module_bus", "publishers")

_SCAN = "{header: {stamp: {sec: 3, nsec: 5}, frame_id: 'laser, front'}, ranges: [0, 1, 2, 3, 4]}"
_TRANSFORMS = "{transforms: [{header: {frame_id: odom}}, {header: {frame_id: map}}]}"

# The numbers 0 to 9 again and again, and what is no known type in between.
_COUNTER = """
import time
import lcm
from lcmtools.types.std_msgs import Int32

bus = lcm.LCM()
number = Int32()
while True:
    bus.publish("NUMBER", number.encode())
    bus.publish("NOISE", bytes(range(40)))
    number.data = (number.data + 1) % 10
    print("sent", flush=True)
    time.sleep(0.02)
"""


@pytest.fixture(scope="module")
def publishers(module_start, lcmtools_path, tmp_path_factory):
    """/scan, /tf and /chatter of nodes that announce their types; NUMBER and NOISE of a script."""
    script = tmp_path_factory.mktemp("counter") / "counter.py"
    script.write_text(_COUNTER)
    counter = module_start(sys.executable, str(script))
    for topic, kind, values in [
        ("/scan", "sensor_msgs/LaserScan", _SCAN),
        ("/tf", "tf2_msgs/TFMessage", _TRANSFORMS),
        ("/chatter", "std_msgs/String", 'data: "a \\"word\\",\\nor two"'),
    ]:
        started = module_start(lcmtools_path, "pub", "-r", "30", topic, kind, values)
        started.wait_for("no node subscribes")
    counter.wait_for("sent")


def output(result):
    assert (result.code, result.err) == (0, "")
    return result.out


@pytest.mark.parametrize(
    ("argument", "text"),
    [
        ("/scan/ranges[0:3]", "[0.0, 1.0, 2.0]"),
        ("/scan/ranges[::-2]", "[4.0, 2.0, 0.0]"),
        ("scan/ranges[-1]", "4.0"),
        ("/scan.header.frame_id", '"laser, front"'),
        ("/scan/header/stamp", "sec: 3\nnsec:         5"),
        ("/chatter/data", '"a \\"word\\",\\nor two"'),
        ("/chatter/", 'data: "a \\"word\\",\\nor two"'),
        ("/tf/transforms[1].header/frame_id", '"map"'),
        ("/tf/transforms[:].header.frame_id", "- odom\n- map"),
    ],
)
def test_a_field_path_behind_the_topic_shows_that_field(argument, text, cli):
    assert output(cli("echo", argument, "-1")) == f"{text}\n---\n"


def test_several_fields_are_shown_by_their_paths(cli):
    fields = ("--field", "header.stamp.sec", "--field", "/ranges[0:2]")
    shown = "header.stamp.sec: 3\nranges[0:2]: [0.0, 1.0]\n---\n"
    assert output(cli("echo", "/scan", "-1", *fields)) == shown
    record = json.loads(output(cli("echo", "/scan", "-1", "--json", *fields)))
    assert record == {"header.stamp.sec": 3, "ranges[0:2]": [0.0, 1.0]}


def test_field_goes_on_where_the_topics_path_ends(cli):
    assert output(cli("echo", "/scan/header", "--field", "stamp.sec", "-1")) == "3\n---\n"


def test_json_of_a_field_is_that_field(cli):
    assert output(cli("echo", "/scan/ranges[3:]", "-1", "--json")) == "[3.0,4.0]\n"


def test_filter_shows_the_messages_that_meet_it(cli):
    result = cli("echo", "NUMBER/data", "--filter", "m.data % 3 == 1 and data < 5", "-n", "4")
    assert set(output(result).split()) == {"1", "4", "---"}


def test_timeout_is_for_messages_that_meet_the_filter(cli):
    result = cli("echo", "NUMBER", "--filter", "data > 99", "--timeout", "500ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, "lcmtools echo: nothing", "NUMBER", "0.5 s; ")


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (["/chatter/nope"], "nope: std_msgs/String has no field 'nope' (fields: data)"),
        (["/chatter[0]"], "the message is not an array but a std_msgs/String (fields: data)"),
        (["/scan/ranges[9]"], "ranges[9]: the array has 5 elements, none at [9]"),
        (
            ["/scan/ranges[a]"],
            "field path '/ranges[a]': 'a' is not a whole number; write [0], [-1], [0:5] or [::2]",
        ),
        (
            ["/chatter", "--field", "nope"],
            "nope: std_msgs/String has no field 'nope' (fields: data)",
        ),
        (["NUMBER.nope"], "nope: std_msgs/Int32 has no field 'nope' (fields: data)"),
        (
            ["/chatter", "--filter", "m.nope == 1"],
            "m.nope: std_msgs/String has no field 'nope' (fields: data)",
        ),
        (["NUMBER", "--filter", "nope"], "nope: std_msgs/Int32 has no field 'nope' (fields: data)"),
        (["/chatter", "--csv", "--json"], "--json and --csv exclude each other; leave out --csv"),
        (
            ["/chatter/data", "--raw"],
            "--raw shows whole messages; leave out the field, or --raw",
        ),
        (
            ["/chatter", "--raw", "--nostr"],
            "--raw shows whole messages; leave out --nostr",
        ),
    ],
)
def test_a_mistake_ends_echo_with_one_line_and_exit_code_2(arguments, error, cli):
    result = cli("echo", *arguments)
    assert (result.code, result.out) == (2, "")
    assert result.err == f"lcmtools echo: {error}\n"


def test_noarr_and_nostr_name_what_they_hide(cli):
    shown = output(cli("echo", "/scan", "-1", "--noarr", "--nostr")).splitlines()
    assert 'ranges: "<array type: float32, length: 5>"' in shown
    assert '  frame_id: "<string length: 12>"' in shown
    assert "angle_min: 0.0" in shown
    record = json.loads(output(cli("echo", "/tf", "-1", "--json", "--noarr")))
    assert record == {
        "transforms": "<array type: geometry_msgs/TransformStamped, length: 2>",
    }


def test_csv_has_rostopics_columns_and_the_headers_stamp(cli):
    first, second, third = csv.reader(output(cli("echo", "/scan", "-n", "2", "-p")).splitlines())
    header = ["field.header.seq", "field.header.stamp", "field.header.frame_id"]
    assert first[:4] == ["%time", *header]
    assert first[-5:] == [f"field.ranges{index}" for index in range(5)]
    assert second[:4] == ["3000000005", "0", "3000000005", "laser, front"]
    assert second == third


def test_csv_quotes_text_and_takes_the_arrival_where_there_is_no_header(cli):
    head, row = output(cli("echo", "/chatter/data", "-1", "--csv")).split("\n", 1)
    assert head == "%time,field"
    time, text = row.split(",", 1)
    assert len(time) == 19
    assert text == '"a ""word"",\nor two"\n'


def test_flow_style_is_one_line_a_message(cli):
    shown = output(cli("echo", "/scan/header", "-1", "--flow-style"))
    assert shown == '{seq: 0, stamp: {sec: 3, nsec: 5}, frame_id: "laser, front"}\n---\n'


def test_raw_is_the_payload_in_hexadecimal(cli):
    assert output(cli("echo", "NOISE", "-1", "--raw")) == f"{bytes(range(40)).hex()}\n"
    record = json.loads(output(cli("echo", "NOISE", "-1", "--raw", "--json")))
    assert record == {"bytes": 40, "data": bytes(range(40)).hex()}


def test_fields_of_an_unknown_type_are_said_to_be_unknown_once(cli):
    result = cli("echo", "NOISE/x", "--timeout", "400ms")
    assert (result.code, result.out) == (4, "")
    first, second = result.err.splitlines()
    assert_says(first, "lcmtools echo: ", "NOISE", "0x0001020304050607; ", "LCMTOOLS_TYPE_PATH=")
    assert_says(second, "lcmtools echo: nothing", "NOISE")


def test_a_topic_that_comes_later_is_told_from_its_path(start, lcmtools_path):
    echo = start(lcmtools_path, "echo", "/later/topic/data", "-1")
    echo.wait_for("no message on /later/topic/data yet")
    start(lcmtools_path, "pub", "-r", "20", "/later/topic", "std_msgs/Int32", "7")
    assert echo.wait() == 0
    assert echo.lines[-2:] == ["7", "---"]
