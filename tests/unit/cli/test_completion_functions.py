"""Candidates at a place of the command line, for a bus that is known."""

import lcm
import pytest

from lcmtools.bag.reindex import reindex_log
from lcmtools.cli.completion.situation import FILES, Situation, candidates
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.std_msgs import Header

PUBLISHED = [
    ("/chatter", "std_msgs/String"),
    ("/husky0/odometry", "nav_msgs/Odometry"),
    ("/scan", "sensor_msgs/LaserScan"),
    ("/_private/x", "std_msgs/String"),
]
GRAPH = Graph(
    nodes=(
        NodeInfo(
            "/husky0/driver",
            "1",
            "morse",
            1,
            endpoints=(
                *(Endpoint(topic, Role.PUBLISHER, (kind,)) for topic, kind in PUBLISHED),
                Endpoint("/reset", Role.SERVICE, ("std_srvs/SetBool",)),
                Endpoint("/husky0/_hidden", Role.SERVICE, ("std_srvs/Trigger",)),
            ),
        ),
        NodeInfo("/_lcmtools_echo_1", "2", "morse", 2, tool=True),
    ),
    traffic=(
        Traffic("EXAMPLE", None, (fingerprint(message_class("geometry_msgs/Twist")),), 1, 0, 0, 0),
    ),
)


def complete(source, word="", **given):
    lists = {name: value.split("|") for name, value in given.items()}
    situation = Situation(word, lists, environment={})
    situation.__dict__["graph"] = GRAPH
    found = candidates(source, situation)
    return ["files" if one is FILES else one.value for one in found if one.value.startswith(word)]


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("", ["/chatter", "/husky0/odometry", "/scan", "EXAMPLE"]),
        ("/h", ["/husky0/odometry"]),
        ("chat", ["chatter"]),
        ("husky0/o", ["husky0/odometry"]),
        ("EX", ["EXAMPLE"]),
        ("/_", ["/_private/x"]),
    ],
)
def test_topics_are_spelled_as_the_word_begins(word, found):
    assert complete("bus:topics", word) == found


def test_a_topic_that_is_given_already_is_not_offered_again():
    assert "/scan" not in complete("bus:topics", "/", topics="/scan|/chatter")


def test_a_relative_topic_stands_in_the_namespace():
    assert complete("bus:topics", "odo", ns="/husky0") == ["odometry"]


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("/chatter.", ["/chatter.data"]),
        ("/husky0/odometry/po", ["/husky0/odometry/pose"]),
        ("/husky0/odometry.pose.pose.position.", ["x", "y", "z"]),
        ("/scan/ranges[", ["[0]", "[-1]", "[0:5]", "[::10]"]),
        ("/scan/nonsense.", []),
        ("/scan/ranges[0].", []),
        ("/unknown.", []),
        ("EXAMPLE.linear.", ["x", "y", "z"]),
    ],
)
def test_fields_are_offered_behind_a_topic(word, found):
    offered = complete("messages:topics_and_fields", word)
    assert len(offered) == len(found)
    assert all(one.endswith(end) for one, end in zip(offered, found, strict=True))


def test_a_field_that_is_written_out_leads_on_to_its_own_fields():
    assert complete("messages:topics_and_fields", "/husky0/odometry/pose") == [
        "/husky0/odometry/pose",
        "/husky0/odometry/pose/pose",
        "/husky0/odometry/pose/covariance",
    ]


def test_the_value_of_field_is_a_path_of_the_topic():
    assert complete("messages:fields", "hea", topic="/scan") == ["header"]
    assert complete("messages:fields", "header.", words="/scan") == [
        "header.seq",
        "header.stamp",
        "header.frame_id",
    ]
    assert (
        complete("messages:fields", "position.", topic="/husky0/odometry.pose.pose")[0]
        == "position.x"
    )


def test_the_type_of_the_topic_comes_first_and_alone_before_anything_is_typed():
    assert complete("messages:types", topic="/chatter") == ["std_msgs/String"]
    assert complete("messages:types", topic="chatter") == ["std_msgs/String"]
    assert complete("messages:types", "std_msgs/", topic="/chatter")[0] == "std_msgs/String"
    assert len(complete("messages:types", "std_msgs/", topic="/chatter")) > 5


@pytest.mark.parametrize(
    ("word", "found"),
    [
        ("geometry_msgs/TwistS", "geometry_msgs/TwistStamped"),
        ("geometry_msgs/msg/TwistS", "geometry_msgs/msg/TwistStamped"),
        ("geometry_msgs.TwistS", "geometry_msgs.TwistStamped"),
        ("TwistS", "TwistStamped"),
        ("geo", "geometry_msgs/Accel"),
    ],
)
def test_types_are_spelled_as_the_word_begins(word, found):
    assert complete("messages:types", word)[0] == found


def test_packages_come_before_types():
    packages = complete("messages:types")
    assert "geometry_msgs/" in packages
    assert all(name.endswith("/") for name in packages)


def test_a_prototype_is_one_word_that_pub_accepts():
    (text,) = complete("messages:prototypes", type_="geometry_msgs/Twist")
    assert text == "{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}"
    kind = message_class("nav_msgs/Odometry")
    (text,) = complete("messages:prototypes", type_="nav_msgs/Odometry")
    draft_from_values(kind, [text])


def test_there_is_no_prototype_behind_a_value_or_a_file_or_for_an_unknown_type():
    assert complete("messages:prototypes", type_="std_msgs/String", values="x") == []
    assert complete("messages:prototypes", type_="std_msgs/String", file="x") == []
    assert complete("messages:prototypes", type_="std_msgs/Bogus") == []


def test_a_service_leads_to_its_request():
    assert complete("bus:services", "") == ["/reset"]
    assert complete("messages:requests", service="/reset") == ["{data: false}"]
    assert complete("messages:requests", "std", service="reset") == ["std_srvs/SetBool"]
    assert complete("messages:requests", service="/reset", words="std_srvs/SetBool") == [
        "{data: false}"
    ]


def test_nodes_hosts_and_namespaces_of_the_bus():
    assert complete("bus:nodes") == ["/husky0/driver"]
    assert complete("bus:nodes", "dri") == ["driver"]
    assert complete("bus:nodes", "/_l") == ["/_lcmtools_echo_1"]
    assert complete("bus:hosts") == ["morse"]
    assert complete("bus:namespaces") == ["/husky0"]
    assert complete("bus:namespaces", "hus") == ["husky0"]


def test_robots_are_those_that_simulators_take_commands_for():
    steered = [
        Endpoint(topic, Role.SUBSCRIBER, group=f"wheel command of {robot}")
        for topic, robot in [("/cmd_vel", "/"), ("/husky1/a", "/husky1"), ("/husky1/b", "/husky1")]
    ]
    state = Endpoint("/sim/get_state", Role.SERVICE, ("sim_msgs/GetState",))
    clock = Endpoint("/clock", Role.SUBSCRIBER)
    simulator = NodeInfo("/sim", "3", "morse", 3, endpoints=(state, clock, *steered))
    other = NodeInfo("/other", "4", "morse", 4, endpoints=(steered[0], clock))

    def robots(word):
        situation = Situation(word, {}, environment={})
        situation.__dict__["graph"] = Graph(nodes=(*GRAPH.nodes, other, simulator))
        return [one.value for one in candidates("bus:robots", situation)]

    assert robots("") == robots("/") == ["/", "/husky1"]
    assert "husky1" in robots("hus")


@pytest.mark.parametrize(
    ("word", "given", "found"),
    [
        ("", {}, ["__ns:=", "__name:="]),
        ("__ns:=/", {}, ["__ns:=/husky0"]),
        ("cha", {}, ["chatter:="]),
        ("chatter:=/sc", {}, ["chatter:=/scan"]),
        ("--na", {}, ["--name"]),
        ("/hus", {"arguments": "--ns"}, ["/husky0"]),
        ("--ns=/hus", {}, ["--ns=/husky0"]),
    ],
)
def test_arguments_that_every_node_takes(word, given, found):
    assert complete("runnables:arguments", word, name="talker", **given) == found


def test_files_and_programs_of_packages_can_be_run(tmp_path, monkeypatch):
    project = '[project]\nname = "air_lab0"\n[tool.lcmtools]\n'
    for name, text in {"mine.py": "", "air_lab0/pyproject.toml": project}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "air_lab0" / "evaluate_controller.py").touch(mode=0o755)
    monkeypatch.chdir(tmp_path)
    assert {"talker", "air_lab0", "mine.py"} <= set(complete("runnables:programs"))
    assert list(candidates("runnables:programs", Situation("./"))) == [FILES]
    assert "evaluate_controller.py" in complete("runnables:arguments", name="air_lab0")


def test_the_simulator_says_what_its_own_arguments_are():
    assert "husky" in complete("runnables:arguments", name="sim", arguments="--world")
    assert "--world=husky" in complete("runnables:arguments", "--world=", name="sim")
    assert complete("runnables:arguments", "./", name="sim", arguments="--world") == []
    assert "files" in complete("runnables:arguments", "", name="sim", arguments="--check")
    assert "--world" in complete("runnables:arguments", "--wo", name="sim")


def test_a_source_may_be_words_or_files_or_nothing():
    assert complete("") == []
    assert complete([["red"], ["green"]], "g") == ["green"]
    assert complete("files") == ["files"]


def test_what_is_left_out_of_a_graph_is_any_name_once():
    names = ["/husky0", "/chatter", "/husky0/odometry", "/scan", "EXAMPLE", "/husky0/driver"]
    assert complete("bus:names") == names
    assert complete("bus:names", "/husky0", excluded="/husky0") == names[2:3] + names[5:]


def test_a_node_stands_behind_the_file_or_in_its_place():
    assert complete("bus:nodes_after_file") == ["files"]
    assert complete("bus:nodes_after_file", words="gains.yaml") == ["/husky0/driver"]
    assert complete("bus:nodes_and_files") == ["/husky0/driver", "files"]


def test_words_that_were_kept_have_their_help():
    kept = [["ttl", "how far messages go"], ["loss", "lost messages"]]
    found = candidates(kept, Situation(environment={}))
    assert [[one.value, one.help] for one in found] == kept


def test_a_labs_simulator_takes_its_own_arguments_but_no_world():
    assert complete(
        "lcmtools.labs.commands.completion:simulator_arguments", "--ra", name="husky"
    ) == ["--rate"]
    assert complete("lcmtools.labs.commands.completion:simulator_arguments", name="husky") == [
        "__ns:=",
        "__name:=",
    ]


@pytest.mark.parametrize("is_indexed", [True, False])
def test_a_log_in_place_of_the_bus_has_the_names(*, is_indexed, tmp_path):
    path = str(tmp_path / "ride.lcmlog")
    log = lcm.EventLog(path, "w")
    log.write_event(1, "/said", encode(Header()))
    log.close()
    if is_indexed:
        with LogFile(path) as opened:
            reindex_log(opened)

    def found(source, word, **given):
        return [one.value for one in candidates(source, Situation(word, given, environment={}))]

    assert found("bus:topics", "/", bag=[path]) == ["/said"]
    assert "/said.frame_id" in found("messages:topics_and_fields", "/said.", bag=[path])
    assert found("logs:topics", "", files=[path]) == ["/said"]
    assert found("bus:topics", "/", bag=[f"{path}.missing"]) == []
