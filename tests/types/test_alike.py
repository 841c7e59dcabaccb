"""Types with the same fields: the likeliest first, and marked as one of several everywhere."""

import json

import pytest

from lcmtools import message_class
from lcmtools.graph.builder import _with_observed_topics
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import fingerprint
from lcmtools.observe.channels.columns import type_text as column_text
from lcmtools.observe.channels.rows import ChannelRow
from lcmtools.observe.reading.decoding import possible_types
from lcmtools.observe.reports import node_report
from lcmtools.observe.reports.bus_diagram import diagram_of
from lcmtools.observe.reports.describe import topic_kinds, type_text, types_json
from lcmtools.wire.packet import Sender

POINTS = ["arm/point_t", "geometry_msgs/Vector3", "geometry_msgs/Point"]
SENDER = Sender("10.0.0.1", 4000)


def number(name):
    return fingerprint(message_class(name))


@pytest.mark.parametrize(
    ("name", "channel", "announced", "first", "count"),
    [
        pytest.param("arm/point_t", "A", (), "arm/point_t", 3, id="own before shipped"),
        pytest.param("arm/point_t", "TARGET_POINT", (), "arm/point_t", 3, id="own of two alike"),
        pytest.param("arm/point_t", "VECTOR", (), "geometry_msgs/Vector3", 3, id="named so"),
        pytest.param(
            *("arm/point_t", "VECTOR", ("geometry_msgs/Point",), "geometry_msgs/Point", 1),
            id="announced",
        ),
        pytest.param(
            *("arm/point_t", "/a#geometry_msgs.Point", (), "geometry_msgs/Point", 1),
            id="in the channel's name",
        ),
        pytest.param(
            *("drake/lcmt_iiwa_command", "IIWA_COMMAND", (), "drake/lcmt_iiwa_command", 2),
            id="the first of two own",
        ),
        pytest.param(
            *("drake/lcmt_iiwa_command", "allegroCommand", (), "drake/lcmt_allegro_command", 2),
            id="the second of two own",
        ),
        pytest.param("geometry_msgs/Twist", "/accel", (), "geometry_msgs/Accel", 2, id="shipped"),
        pytest.param("geometry_msgs/Twist", "/cmd", (), "geometry_msgs/Twist", 2, id="preferred"),
    ],
)
def test_the_likeliest_type_of_a_channel_comes_first(
    family, name, channel, announced, first, count
):
    family("alike")
    found = possible_types(number(name), channel, announced)
    assert (found[0], len(found)) == (first, count)


def seen(*ends):
    node = NodeInfo("/n", "n", "h", 1, endpoints=ends)
    traffic = Traffic("A", SENDER, (number("arm/point_t"),), 1, 32, 0, 0)
    return Graph((node,) if ends else (), (traffic,))


def test_what_is_uncertain_is_marked(family):
    family("alike")
    topic = seen().topic("A")
    assert type_text(topic) == "arm/point_t (one of 3)"
    assert types_json(topic_kinds(topic)) == {"type": "arm/point_t", "types": POINTS}
    assert column_text(ChannelRow("A", tuple(POINTS), messages=1)) == "arm/point_t +2"


def test_what_is_announced_is_not(family):
    family("alike")
    end = Endpoint("A", Role.SUBSCRIBER, ("geometry_msgs/Point",), (number("arm/point_t"),))
    topic = seen(end).topic("A")
    assert type_text(topic) == "geometry_msgs/Point"
    assert types_json(topic_kinds(topic))["types"] == ["geometry_msgs/Point"]


def test_a_node_whose_announcement_is_not_readable_has_the_types_of_its_messages(family):
    family("alike")
    node = NodeInfo("/n", "n", "h", 1, sender=SENDER, has_details=False)
    node = _with_observed_topics(node, {SENDER: seen().traffic})
    assert " * A [arm/point_t (one of 3)]" in node_report.roles(node, show_hidden=False)
    record = node_report.to_json(node, Graph((node,)), 0)
    (publication,) = record["publications"]
    assert publication["types"] == POINTS
    (channel,) = diagram_of(Graph((node,), seen().traffic), (), None).channels
    assert (channel.type_text, channel.types) == ("arm/point_t (one of 3)", tuple(POINTS))


def test_commands_mark_it_in_a_log(family, cli, log_of, tmp_path):
    family("alike")
    log = log_of("A", encode(message_class("arm/point_t")()))
    assert cli("list", "-b", log, "-t").ok() == "A [arm/point_t (one of 3)]\n"
    assert "Type: arm/point_t (one of 3)\n" in cli("info", "-b", log, "A").ok()
    assert "  arm/point_t (one of 3)  " in cli("bag", "info", log).ok()
    told = cli("type", "-b", log, "A")
    assert (told.out, told.code) == ("arm/point_t\n", 0), "for msg show behind a pipe"
    assert told.err.endswith(f"one of several types with the same fields: {', '.join(POINTS)}\n")
    for words in (["list", "-b", log], ["info", "-b", log, "A"], ["type", "-b", log, "A"]):
        record = json.loads(cli(*words, "--json").out)
        record = record[0] if isinstance(record, list) else record
        assert (record["type"], record["types"]) == ("arm/point_t", POINTS), words
    (topic,) = json.loads(cli("bag", "info", log, "--json").ok())[0]["topics"]
    assert topic["types"] == POINTS
    assert cli("bag", "export", log, str(tmp_path / "a.jsonl")).code == 0
    row = json.loads((tmp_path / "a.jsonl").read_text())
    assert (row["type"], row["types"]) == ("arm/point_t", POINTS)


def test_an_mcap_file_has_it_beside_the_schema(family, cli, log_of, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    family("alike")
    log = log_of("A", encode(message_class("arm/point_t")()))
    assert cli("bag", "export", log, str(tmp_path / "a.mcap")).code == 0
    with (tmp_path / "a.mcap").open("rb") as file:
        (channel,) = reader.make_reader(file).get_summary().channels.values()
    assert channel.metadata == {"possible_types": ", ".join(POINTS)}


def test_what_a_log_stored_counts_where_its_files_are_not_here(family, monkeypatch, tmp_path):
    from lcmtools.packages import provide_recorded_types, provide_user_types
    from lcmtools.wire.log_index import RecordedType

    text = (family("alike") / "arm/point_t.lcm").read_text()
    one = RecordedType("arm/point_t", number("arm/point_t"), "arm/point_t.lcm", text)
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", "")
    monkeypatch.chdir(tmp_path)
    provide_user_types()
    assert possible_types(one.fingerprint) == POINTS[1:]
    provide_recorded_types([one])
    assert possible_types(one.fingerprint) == POINTS
    assert message_class("arm/point_t", one.fingerprint).__slots__ == ["x", "y", "z"]
