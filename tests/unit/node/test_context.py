"""The context that nodes of one process share: their names, their end, their records."""

import os
import threading

import pytest
from fixtures.says import raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.errors import InvalidName, LcmtoolsError
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import String


@pytest.mark.parametrize(
    ("words", "environment", "coded", "name", "topic"),
    [
        ([], {}, "", "/driver", "/scan"),
        ([], {}, "/robot", "/robot/driver", "/robot/scan"),
        ([], {}, "robot", "/robot/driver", "/robot/scan"),
        (["__ns:=/husky0"], {}, "", "/husky0/driver", "/husky0/scan"),
        (["__ns:=husky0/"], {}, "", "/husky0/driver", "/husky0/scan"),
        (["--ns", "/husky0"], {}, "/robot", "/husky0/driver", "/husky0/scan"),
        (["__ns:=/"], {}, "/robot", "/driver", "/scan"),
        ([], {"LCMTOOLS_NAMESPACE": "env"}, "", "/env/driver", "/env/scan"),
        (["__ns:=/husky0"], {"LCMTOOLS_NAMESPACE": "/env"}, "", "/husky0/driver", "/husky0/scan"),
        (["__ns:=/"], {"LCMTOOLS_NAMESPACE": "/env"}, "", "/driver", "/scan"),
        ([], {"LCMTOOLS_NAMESPACE": ""}, "", "/driver", "/scan"),
        (["__name:=bob"], {}, "", "/bob", "/scan"),
        (["--name=bob", "scan:=laser"], {}, "/robot", "/robot/bob", "/robot/laser"),
        (["scan:=~laser"], {}, "", "/driver", "/driver/laser"),
        (["/scan:=/laser"], {}, "", "/driver", "/laser"),
    ],
)
def test_a_node_gets_its_name_and_topics_from_the_command_line(
    begin, words, environment, coded, name, topic
):
    begin(*words, environment=environment)
    node = Node("driver", namespace=coded)
    assert node.name == name
    assert node.create_publisher(String, "scan").topic == topic
    assert node.create_subscription(String, "scan", print).topic == topic
    assert node.resolve_name("scan") == topic


@pytest.mark.parametrize("name", ["", "a/b", "/a", "1a", "a b", "a.b", "é"])
def test_an_illegal_node_name_is_refused(begin, name):
    begin()
    with pytest.raises(InvalidName):
        Node(name)


@pytest.mark.parametrize("words", [["__name:=a/b"], ["__ns:=a b"], ["__ns:=~a"], ["--name", "1"]])
def test_an_illegal_name_on_the_command_line_is_refused(begin, words):
    begin(*words)
    with pytest.raises(InvalidName):
        Node("driver")


def test_a_name_that_is_too_long_is_refused(begin):
    begin(f"__ns:=/{'n' * 40}")
    with pytest.raises(InvalidName, match="63"):
        Node("d" * 40)


def test_an_illegal_namespace_in_the_environment_is_refused(begin):
    with pytest.raises(InvalidName):
        begin(environment={"LCMTOOLS_NAMESPACE": "a b"})


def test_a_name_on_the_command_line_is_the_first_nodes(begin):
    begin("__name:=bob", "__ns:=/x")
    assert [Node("a").name, Node("b").name] == ["/x/bob", "/x/b"]


def test_two_nodes_of_a_process_speak_to_each_other(begin):
    begin()
    heard = []
    a, b = Node("a"), Node("b")
    publisher = a.create_publisher(String, "chatter")
    b.create_subscription(String, "chatter", lambda message: heard.append(message.data))
    publisher.publish(String())
    lcmtools.spin_once(a)
    assert heard == []
    lcmtools.spin_once(b)
    assert heard == [""]


def test_two_nodes_spin_together(begin):
    context = begin()
    a, b, called = Node("a"), Node("b"), []
    a.create_timer(0.001, lambda: called.append("a"))

    def last():
        called.append("b")
        if "a" in called:
            context.stop()

    b.create_timer(0.001, last)
    lcmtools.spin(a, b)
    assert {"a", "b"} == set(called)


def test_a_node_is_a_context_manager(begin, bus):
    begin()
    with Node("a") as node:
        assert node.name == "/a"
    last = decode_announcement([p for channel, p in bus.published if channel == NODE_CHANNEL][-1])
    assert last is not None
    assert last.leaving


def test_a_destroyed_node_unsubscribes_everything(begin, bus):
    from lcmtools.types.std_srvs import Trigger

    begin()
    before = {channel for channel, handlers in bus._handlers.items() if handlers}
    node = Node("a")
    node.create_subscription(String, "chatter", print)
    node.create_service(Trigger, "go", lambda _, response: response)
    node.create_client(Trigger, "come")
    node.destroy_node()
    assert {channel for channel, handlers in bus._handlers.items() if handlers} == before


def test_a_closed_context_is_closed_for_good(begin):
    context = begin()
    node = Node("a")
    context.close()
    context.close()
    node.destroy_node()
    assert context.is_closed()
    assert not context.ok()
    lcmtools.spin(node)
    lcmtools.spin_once(node, 1.0)


def test_closing_inside_a_callback_ends_the_spin(begin, bus):
    context = begin()
    node, heard = Node("a"), []

    def end(_message):
        heard.append(1)
        context.close()

    node.create_subscription(String, "chatter", end)
    for _ in range(3):
        bus.publish("/chatter", encode(String()))
    lcmtools.spin(node)
    assert heard == [1]


def test_closing_on_another_thread_ends_the_spin(begin):
    for _ in range(20):
        context = begin()
        node = Node("a")
        node.create_timer(0.001, lambda: None)
        closer = threading.Timer(0.002, context.close)
        closer.start()
        lcmtools.spin(node)
        closer.join()


def test_spinning_waits_no_longer_than_it_should(begin, stopwatch):
    import time

    begin()
    node = Node("a")
    before, watch = time.monotonic(), stopwatch()
    lcmtools.spin_once(node, 0.03)
    assert time.monotonic() - before > 0.025
    assert watch.seconds() < 1.0


def test_a_message_wakes_a_waiting_spin(begin, bus):
    begin()
    node, heard = Node("a"), []
    node.create_subscription(String, "chatter", lambda _: heard.append(1))
    sender = threading.Timer(0.02, lambda: bus.publish("/chatter", encode(String())))
    sender.start()
    lcmtools.spin_once(node, None)
    sender.join()
    assert heard == [1]


def test_without_init_there_is_no_node():
    with raises_saying(LcmtoolsError, "no bus", "; ", "lcmtools.init()"):
        Node("a")
    assert not lcmtools.ok()
    lcmtools.shutdown()


def test_init_twice_is_refused(begin):
    begin()
    with pytest.raises(LcmtoolsError, match="called twice"):
        lcmtools.init([], url="memq://")


def test_init_returns_what_is_the_programs_own():
    rest = lcmtools.init(["--ns", "/x", "file", "a:=b", "--speed", "3"], url="memq://")
    try:
        assert rest == ["file", "--speed", "3"]
        assert lcmtools.ok()
        assert Node("n").name == "/x/n"
    finally:
        lcmtools.shutdown()
    assert not lcmtools.ok()
    lcmtools.shutdown()


def test_init_may_be_called_again_after_shutdown():
    for _ in range(3):
        lcmtools.init([], url="memq://")
        Node("a")
        lcmtools.shutdown()


def test_init_on_a_log_that_is_read_is_refused():
    with raises_saying(LcmtoolsError, "a log", "a bus"):
        lcmtools.init([], url="file:///tmp/a.log")
    assert not lcmtools.ok()


def test_an_option_of_the_url_that_has_no_effect_is_logged(capsys):
    lcmtools.init([], url="memq://?ttl=1")
    Node("a")
    lcmtools.shutdown()
    note = "--lcm-url memq://?ttl=1: ttl=1 has no effect; memq has no options"
    assert capsys.readouterr().err.count(note) == 1


def _records(folder):
    return [path for path in folder.rglob("*") if path.is_file()]


def test_a_node_has_a_record_while_it_lives(begin, tmp_path):
    url = parse_url("memq://")
    records = NodeRecords(url, {"XDG_RUNTIME_DIR": str(tmp_path)})
    context = begin(records=records)
    a, _ = Node("a"), Node("b")
    assert {node.name for node in records.read()} == {"/a", "/b"}
    assert {node.pid for node in records.read()} == {os.getpid()}
    a.destroy_node()
    assert {node.name for node in records.read()} == {"/b"}
    context.close()
    assert _records(tmp_path) == []
