"""list, info, type, echo, hz and node ... on a bus with a talker and a listener."""

import json
import os
import re
import socket

import pytest
from fixtures.says import assert_line, assert_says

HOST = socket.gethostname()

pytestmark = pytest.mark.usefixtures("use_module_bus", "nodes")


@pytest.fixture(scope="module")
def nodes(module_start, lcmtools_path):
    """A talker and a listener that have met; their pids."""
    listener = module_start(lcmtools_path, "run", "listener")
    talker = module_start(lcmtools_path, "run", "talker")
    listener.wait_for("I heard: [hello world")
    return {"talker": talker.pid, "listener": listener.pid}


def test_list_prints_the_topics_sorted(cli):
    result = cli("list")
    assert (result.code, result.out, result.err) == (0, "/chatter\n/rosout\n", "")


def test_topic_list_is_list(cli):
    assert cli("topic", "list").out == cli("list").out


def test_list_v_has_the_sections_of_rostopic(cli):
    assert cli("list", "-v").out == (
        "\n"
        "Published topics:\n"
        " * /chatter [std_msgs/String] 1 publisher\n"
        " * /rosout [rosgraph_msgs/Log] 2 publishers\n"
        "\n"
        "Subscribed topics:\n"
        " * /chatter [std_msgs/String] 1 subscriber\n"
        "\n"
    )


def test_list_t_shows_the_types(cli):
    lines = cli("list", "-t").out.splitlines()
    assert lines == ["/chatter [std_msgs/String]", "/rosout [rosgraph_msgs/Log]"]


@pytest.mark.parametrize(
    ("option", "topics"), [("-p", ["/chatter", "/rosout"]), ("-s", ["/chatter"])]
)
def test_list_keeps_to_what_is_published_or_subscribed_to(option, topics, cli):
    assert cli("list", option).out.splitlines() == topics


@pytest.mark.parametrize(
    ("option", "heading"), [("-vp", "Published topics:"), ("-vs", "Subscribed topics:")]
)
def test_list_v_has_one_section_where_one_is_asked_for(option, heading, cli):
    lines = cli("list", option).out.splitlines()
    assert [line for line in lines if line.endswith(":")] == [heading]


def test_list_hz_measures_how_often_messages_come(cli):
    chatter, rosout = cli("list", "--hz", "-t").out.splitlines()
    name, kind, rate, unit = chatter.split()
    assert (name, kind, unit) == ("/chatter", "[std_msgs/String]", "Hz")
    assert float(rate) == pytest.approx(10, abs=2.5)
    assert rosout.startswith("/rosout [rosgraph_msgs/Log]")
    (record,) = json.loads(cli("list", "--hz", "--json", "chatter").out)
    assert record["rate"] == pytest.approx(10, abs=2.5)
    assert ", " in cli("list", "--hz", "-v", "chatter").out
    assert "rate" not in json.loads(cli("list", "--json", "chatter").out)[0]


def test_list_host_groups_the_topics_by_computer(cli):
    assert cli("list", "--host").out == f"Host [{HOST}]:\n  /chatter\n  /rosout\n"


def test_list_c_is_how_many_topics_there_are(cli):
    assert cli("list", "-c").out == "2\n"
    assert cli("list", "-c", "/nowhere").out == "0\n"


@pytest.mark.parametrize("pattern", ["/chat*", "chat*", "*ter", "/chatte?", "/?hatter"])
def test_list_keeps_to_what_matches_a_pattern(pattern, cli):
    assert cli("list", pattern).out == "/chatter\n"


def test_list_json_has_who_publishes_and_who_subscribes(cli):
    assert json.loads(cli("list", "--json").out)[0] == {
        "topic": "/chatter",
        "type": "std_msgs/String",
        "types": ["std_msgs/String"],
        "publishers": ["/talker"],
        "subscribers": ["/listener"],
        "other_senders": [],
    }


@pytest.mark.parametrize("name", ["chatter", "/chatter", "/chatter/"])
def test_list_keeps_to_a_namespace_or_topic(name, cli):
    assert cli("list", name).out == "/chatter\n"


def test_list_of_a_namespace_where_nothing_is_says_so_on_standard_error(cli, module_bus_url):
    result = cli("list", "/chat")
    assert (result.code, result.out) == (0, "")
    assert_line(result.err, "no topics", "/chat", f"{module_bus_url}\n")


def test_list_all_shows_hidden_topics_too(cli, start, lcmtools_path):
    hidden = start(lcmtools_path, "pub", "-r", "20", "/_hidden/a", "std_msgs/String", "x")
    hidden.wait_for("no node subscribes")
    assert "/_hidden/a" not in cli("list").out
    assert "/_hidden/a" in cli("list", "--all").out.splitlines()


def test_info_names_type_nodes_hosts_and_processes(cli, nodes):
    result = cli("info", "chatter")
    assert (result.code, result.err) == (0, "")
    counters = (
        r"     messages: \d+, bytes: \d+, drops: 0, depth: \d+, rate: (\d+\.\d\d) Hz,"
        r" last: \d\.\d s ago"
    )
    text = re.fullmatch(
        r"Type: std_msgs/String\n"
        r"\n"
        r"Publishers: \n"
        rf" \* /talker \({re.escape(HOST)}, pid {nodes['talker']}\)\n"
        rf"{counters}\n"
        r"\n"
        r"Subscribers: \n"
        rf" \* /listener \({re.escape(HOST)}, pid {nodes['listener']}\)\n"
        rf"{counters}, callbacks: [\d.]+ ms mean, [\d.]+ m?s longest\n"
        r"\n"
        r"\n",
        result.out,
    )
    assert text, result.out
    assert [float(rate) for rate in text.groups()] == pytest.approx([10, 10], abs=2.5)


def test_info_v_has_fingerprints_and_command_lines_too(cli):
    lines = cli("info", "-v", "chatter").out.splitlines()
    assert lines[1].startswith("Fingerprint: 0x")
    commands = [line for line in lines if line.startswith("     command: ")]
    assert [line.rpartition(" ")[2] for line in commands] == ["talker", "listener"]


def test_info_of_several_topics_has_a_heading_for_each(cli):
    lines = cli("info", "chatter", "/rosout").out.splitlines()
    assert lines[:2] == ["Topic: /chatter", "Type: std_msgs/String"]
    second = lines.index("Topic: /rosout")
    assert lines[second + 1] == "Type: rosgraph_msgs/Log"


def test_info_says_none_where_nobody_is(cli):
    assert cli("info", "/rosout").out.endswith("\nSubscribers: None\n\n\n")


def test_info_json_has_the_endpoints_with_their_counters(cli, nodes):
    (topic,) = json.loads(cli("info", "--json", "/chatter").out)
    (publisher,) = topic["publishers"]
    assert topic["type"] == "std_msgs/String"
    assert (publisher["node"], publisher["pid"]) == ("/talker", nodes["talker"])
    assert publisher["messages"] > 0
    assert publisher["rate"] == pytest.approx(10, abs=2.5)
    assert publisher["depth"] > 0
    assert publisher["last_time"] > 0
    assert publisher["bytes"] > publisher["messages"] * len("hello world")
    assert [e["node"] for e in topic["subscribers"]] == ["/listener"]
    assert topic["other_publishers"] == []


@pytest.mark.parametrize("command", ["info", "type"])
def test_unknown_topic_is_exit_code_1_with_a_near_miss(command, cli):
    result = cli(command, "chater")
    assert (result.code, result.out) == (1, "")
    assert_line(result.err, f"lcmtools {command}: ", "topic /chater; did you mean /chatter?\n")


def test_topic_of_another_namespace_is_a_near_miss(cli):
    assert cli("info", "/robot/chatter").err.endswith("; did you mean /chatter?\n")


def test_topic_like_no_other_leads_to_list(cli):
    result = cli("info", "zzz")
    assert_line(result.err, "lcmtools info: ", "topic /zzz; lcmtools list")


def test_type_prints_the_type_alone(cli):
    assert cli("type", "chatter").out == "std_msgs/String\n"
    assert json.loads(cli("type", "/chatter", "--json").out) == {
        "topic": "/chatter",
        "type": "std_msgs/String",
        "types": ["std_msgs/String"],
    }


def test_type_of_a_field_is_told_as_rostopic_does(cli):
    assert cli("type", "/chatter/data").out == "std_msgs/String data string\n"
    assert cli("type", "/rosout/header/stamp").out == (
        "rosgraph_msgs/Log header/stamp std_msgs/Time\n"
    )
    assert cli("type", "/rosout/topics").out == "rosgraph_msgs/Log topics string[]\n"
    assert json.loads(cli("type", "chatter.data", "--json").out) == {
        "topic": "/chatter",
        "type": "std_msgs/String",
        "field": "data",
        "field_type": "string",
    }


def test_type_of_an_unknown_field_is_exit_code_1_with_a_near_miss(cli):
    result = cli("type", "/chatter/dota")
    assert (result.code, result.out) == (1, "")
    parts = ("std_msgs/String", "'dota'", "fields: data", "; did you mean data?\n")
    assert_line(result.err, "lcmtools type: ", *parts)


@pytest.mark.parametrize("argument", [[], ["-"]])
def test_type_pipes_into_msg_show(argument, cli):
    kind = cli("type", "/chatter").out
    assert cli("msg", "show", *argument, input=kind).out == "string data\n"


def test_a_piped_type_of_a_service_is_shown(cli):
    result = cli("srv", "show", input="std_srvs/SetBool\n")
    assert result.out == "bool data\n---\nbool success\nstring message\n"


@pytest.mark.parametrize(("said", "what"), [("", "no type"), ("a\nb\n", "several types")])
@pytest.mark.parametrize(
    ("group", "example"), [("msg", "geometry_msgs/Twist"), ("srv", "std_srvs/SetBool")]
)
def test_show_says_what_a_pipe_lacks(group, example, said, what, cli):
    result = cli(group, "show", input=said)
    assert (result.code, result.out) == (2, "")
    parts = ("standard input", what, f"lcmtools {group} show {example}\n")
    assert_line(result.err, f"lcmtools {group} show: ", *parts)


@pytest.mark.parametrize("name", ["chatter", "/chatter"])
def test_echo_n_prints_so_many_messages_as_rostopic_does(name, cli):
    result = cli("echo", "-n", "2", name)
    assert (result.code, result.err) == (0, "")
    first, second = re.fullmatch(
        r'data: "hello world (\d+)"\n---\ndata: "hello world (\d+)"\n---\n', result.out
    ).groups()
    assert int(second) == int(first) + 1


def test_echo_json_is_an_object_a_line(cli):
    lines = cli("echo", "--json", "-n", "3", "chatter").out.splitlines()
    assert len(lines) == 3
    assert all(json.loads(line)["data"].startswith("hello world ") for line in lines)


@pytest.mark.parametrize("option", ["--once", "-1"])
def test_echo_once_is_one_message(option, cli):
    assert cli("echo", option, "/chatter").out.count("---\n") == 1


def test_echo_gives_up_after_its_timeout_with_exit_code_4(cli):
    result = cli("echo", "chater", "--timeout", "200ms")
    assert (result.code, result.out) == (4, "")
    assert_line(result.err, "lcmtools echo: ", "chater", "0.2 s; did you mean /chatter?\n")


def test_echo_tells_what_is_on_the_bus_while_nothing_comes(start, lcmtools_path):
    echo = start(lcmtools_path, "echo", "/zzz")
    line = echo.wait_for("no message on /zzz yet")
    assert_says(line, "lcmtools echo: ", "no message", "/zzz", "; on the bus: /chatter, /rosout")


def test_echo_is_seen_as_a_subscriber_while_it_runs(cli, start, lcmtools_path):
    echo = start(lcmtools_path, "echo", "chatter")
    echo.wait_for("---")
    assert f"/_lcmtools_echo_{echo.pid} ({HOST}, pid {echo.pid})" in cli("info", "chatter").out


def test_hz_prints_the_lines_of_rostopic(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "chatter")
    hz.wait_for("subscribed to [/chatter]")
    assert hz.lines[0] == "subscribed to [/chatter]"
    rate = float(hz.wait_for("average rate: ").removeprefix("average rate: "))
    spread = hz.wait_for("min: ")
    assert rate == pytest.approx(10, abs=2.5)
    assert re.fullmatch(r"\tmin: 0\.\d{3}s max: 0\.\d{3}s std dev: 0\.\d{5}s window: \d+", spread)


def test_hz_w_limits_the_window(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "/chatter", "-w", "3")
    assert hz.wait_for("window: ").endswith("window: 3")


def test_hz_json_is_an_object_a_line(start, lcmtools_path):
    hz = start(lcmtools_path, "hz", "--json", "/chatter")
    measured = json.loads(hz.wait_for("rate"))
    assert measured["topic"] == "/chatter"
    assert measured["rate"] == pytest.approx(10, abs=2.5)
    assert measured["min"] <= 1 / measured["rate"] <= measured["max"]


def test_hz_gives_up_after_its_timeout_with_exit_code_4(cli):
    result = cli("hz", "/zzz", "--timeout", "200ms")
    assert (result.code, result.out) == (4, "")
    assert_says(result.err, "lcmtools hz: ", "/zzz", "within 0.2 s")


def test_node_list_prints_the_nodes_sorted(cli):
    result = cli("node", "list")
    assert (result.code, result.out, result.err) == (0, "/listener\n/talker\n", "")


def test_node_info_has_the_sections_of_rosnode(cli, nodes):
    result = cli("node", "info", "talker")
    assert result.code == 0
    assert result.out.startswith(
        f"{'-' * 80}\n"
        "Node [/talker]\n"
        "Publications: \n"
        " * /chatter [std_msgs/String]\n"
        " * /rosout [rosgraph_msgs/Log]\n"
        "\n"
        "Subscriptions: None\n"
        "\n"
        "Services: "
    )
    assert f"\nHost: {HOST}\nPid: {nodes['talker']}\n" in result.out
    assert re.search(r"\nCommand: .*lcmtools run talker\n", result.out)
    assert re.search(r"\nUp for: \d+ s\n", result.out)
    assert result.out.endswith("Connections:\n * topic: /chatter\n    * to: /listener\n\n")


def test_node_info_json_has_publications_and_subscriptions(cli):
    talker, listener = json.loads(cli("node", "info", "--json", "/talker", "listener").out)
    assert [e["topic"] for e in talker["publications"]] == ["/chatter", "/rosout"]
    assert [e["topic"] for e in listener["subscriptions"]] == ["/chatter"]
    assert listener["stale"] is None


@pytest.mark.parametrize("command", ["info", "ping"])
def test_unknown_node_is_exit_code_1_with_a_near_miss(command, cli):
    result = cli("node", command, "talkr")
    assert (result.code, result.out) == (1, "")
    assert_line(result.err, f"lcmtools node {command}: ", "talkr; did you mean /talker?\n")


def test_node_ping_times_the_answers(cli):
    result = cli("node", "ping", "-c", "2", "talker")
    assert (result.code, result.err) == (0, "")
    head, *replies, average, extremes = result.out.splitlines()
    assert head == "pinging /talker with a timeout of 3.0s"
    assert len(replies) == 2
    assert all(
        re.fullmatch(rf"reply from /talker \({re.escape(HOST)}\)\ttime=\d+\.\d{{6}}ms", reply)
        for reply in replies
    )
    assert re.fullmatch(r"ping average: \d+\.\d{6}ms", average)
    assert re.fullmatch(r"shortest: \d+\.\d{6}ms, longest: \d+\.\d{6}ms", extremes)


def test_node_ping_json_is_one_document(cli):
    document = json.loads(cli("node", "ping", "-c", "1", "--json", "talker").out)
    assert document["node"] == "/talker"
    assert 0 < document["times"][0] < 1


def test_wtf_finds_nothing_wrong_with_exit_code_0(cli):
    wtf = ("wtf", "--wait", "0.2s", "--ignore", "other-buses")  # where other tests run meanwhile
    result = cli(*wtf)
    assert (result.code, result.out, result.err) == (0, "No errors or warnings\n", "")
    assert json.loads(cli(*wtf, "--json").out) == []


@pytest.mark.parametrize("place", ["before", "after"])
def test_bus_can_be_said_before_and_after_the_commands_name(
    place, cli, module_bus_url, monkeypatch
):
    monkeypatch.delenv("LCM_DEFAULT_URL")
    option = ("--lcm-url", module_bus_url)
    for command in (("list",), ("topic", "list")):
        line = (*option, *command) if place == "before" else (*command, *option)
        assert cli(*line).out == "/chatter\n/rosout\n"
    line = ("node", *option, "list") if place == "before" else ("node", "list", *option)
    assert cli(*line).out == "/listener\n/talker\n"


def test_topic_names_resolve_in_the_shells_namespace(cli):
    result = cli("info", "chatter", env={"LCMTOOLS_NAMESPACE": "/husky0"})
    assert_line(result.err, "lcmtools info: ", "/husky0/chatter; did you mean /chatter?\n")


def test_commands_leave_no_trace_on_the_bus(cli):
    cli("node", "cleanup")  # of what other tests have killed
    cli("echo", "-1", "chatter")
    left = json.loads(cli("node", "list", "--all", "--json").out)
    assert [node["node"] for node in left] == ["/listener", "/talker"]
    records = os.path.expandvars("$XDG_RUNTIME_DIR/lcmtools/records")
    assert sum(len(files) for _, _, files in os.walk(records)) == len(left)


def test_nodes_of_other_users_are_no_programs_without_a_node(cli, monkeypatch):
    monkeypatch.setattr("lcmtools.observe.reading.senders.owners", lambda _sockets: {})
    listed = cli("node", "list", "-a").out
    assert "/listener" in listed
    assert "Programs that are no nodes" not in listed
