"""Exceptions of callbacks: one traceback each, then their number, announced from the first on."""

import json
import re
from pathlib import Path

import pytest
from fixtures.says import assert_says

import lcmtools
from lcmtools import Node, Parameter
from lcmtools.clock import NANOSECONDS
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement
from lcmtools.messages.codec import decode, encode
from lcmtools.node import callbacks
from lcmtools.node.callback_errors import place_of
from lcmtools.types.rosgraph_msgs import Log
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger


@pytest.fixture
def clock(monkeypatch):
    """The present of the timers and of the log's pauses [ns]."""
    now = [0]
    monkeypatch.setattr(callbacks.time, "monotonic_ns", lambda: now[0])
    monkeypatch.setattr(callbacks.time, "monotonic", lambda: now[0] / NANOSECONDS)
    return now


def _errors(node):
    return list(node.describe().errors)


def _fail():
    raise AttributeError("no wheels\nat all")


def test_one_traceback_then_a_line_at_growing_intervals_then_the_rest(begin, clock, capsys):
    begin()
    node = Node("a")
    node.create_timer(0.02, _fail)
    for turn in range(1, 1001):
        clock[0] = turn * NANOSECONDS // 50
        lcmtools.spin_once(node)
    log = capsys.readouterr().err
    assert log.count("Traceback") == 1
    counted = re.findall(r"timer 0.02 s raised AttributeError (\d+) times more", log)
    assert list(map(int, counted)) == [50, 100, 200, 400]
    node.destroy_node()
    last = capsys.readouterr().err
    assert_says(last, "timer 0.02 s", "AttributeError", "249", "test_callback_errors.py:")
    assert last.rstrip().endswith("no wheels)")
    assert "\n" not in last.rstrip()
    node.destroy_node()
    assert capsys.readouterr().err == ""


def test_rosout_has_an_error_once(begin, bus, clock):
    begin()
    node = Node("a")
    node.create_timer(1.0, _fail)
    for second in range(1, 20):
        clock[0] = second * NANOSECONDS
        lcmtools.spin_once(node)
    (error,) = _errors(node)
    node.destroy_node()
    entries = [decode(Log, payload) for channel, payload in bus.published if channel == "/rosout"]
    (entry,) = [entry for entry in entries if "raised" in entry.msg]
    assert entry.level == Log.ERROR
    assert "_fail" in entry.msg
    assert (f"{entry.file}:{entry.line}", entry.function) == (error.place, "_fail")
    assert error.place.startswith("test_callback_errors.py:")


def test_the_traceback_begins_in_the_users_code(begin, clock, capsys):
    begin()
    node = Node("a")
    node.create_timer(1.0, _fail)
    clock[0] = NANOSECONDS
    lcmtools.spin_once(node)
    files = re.findall(r'File "(.*)"', capsys.readouterr().err)
    assert [Path(file).name for file in files] == ["test_callback_errors.py"]


def test_each_callback_and_each_line_is_an_error_of_its_own(begin, bus, clock):
    begin()
    node = Node("a")

    def parse(message):
        json.loads(message.data)

    node.create_subscription(String, "chatter", parse)
    node.create_service(Trigger, "reset", lambda _request, _response: None)
    node.create_timer(1.0, _fail)
    for text in ("{", "}"):
        message = String()
        message.data = text
        bus.publish("/chatter", encode(message))
    clock[0] = NANOSECONDS
    lcmtools.spin_once(node)
    by_callback = {error.callback: error for error in _errors(node)}
    assert set(by_callback) == {"/chatter", "timer 1 s"}
    error = by_callback["/chatter"]
    assert (error.exception, error.count) == ("JSONDecodeError", 2)
    assert error.place.startswith("test_callback_errors.py:")  # not json's decoder.py
    assert by_callback["timer 1 s"].message == "no wheels"


def test_an_error_in_a_service_and_in_a_parameter_callback_is_counted(begin, serve, wait_until):
    begin()
    node = Node("a")
    node.declare_parameter("gain", 1.0)

    def refuse(_):
        raise KeyError("gain")

    def fail(_request, _response):
        raise OSError("no power")

    node.add_on_set_parameters_callback(refuse)
    node.create_service(Trigger, "reset", fail)
    serve(node)
    caller = Node("b")
    with pytest.raises(lcmtools.LcmtoolsError, match="no power"):
        caller.create_client(Trigger, "reset").call(Trigger.Request())
    wait_until(lambda: [error.callback for error in _errors(node)] == ["service /reset"])
    with pytest.raises(KeyError):
        node.set_parameters([Parameter("gain", 2.0)])  # one's own call: one's own exception
    assert len(_errors(node)) == 1


def test_a_service_that_returns_nothing_is_an_error_at_its_beginning(begin, serve, wait_until):
    begin()
    node = Node("a")

    def forget(_request, _response):
        """Return nothing."""

    node.create_service(Trigger, "reset", forget)
    serve(node)
    with pytest.raises(lcmtools.LcmtoolsError, match="returned None"):
        Node("b").create_client(Trigger, "reset").call(Trigger.Request())
    wait_until(lambda: bool(_errors(node)))
    (error,) = _errors(node)
    assert error.place == f"test_callback_errors.py:{forget.__code__.co_firstlineno}"
    assert_says(error.message, "; ", "return response")


def test_the_first_error_is_announced_at_once(begin, bus, wait_until):
    begin()
    node = Node("a")
    node.create_subscription(String, "chatter", lambda message: message.text)
    bus.publish("/chatter", encode(String()))
    lcmtools.spin_once(node)

    def announced():
        payloads = [payload for channel, payload in bus.published if channel == NODE_CHANNEL]
        last = decode_announcement(payloads[-1]) if payloads else None
        return last is not None and "AttributeError" in [one.exception for one in last.node.errors]

    wait_until(announced)


def test_a_field_that_is_set_and_does_not_exist_is_explained(begin, bus):
    begin()
    node = Node("a")

    def answer(message):
        message.dta = "x"

    node.create_subscription(String, "chatter", answer)
    bus.publish("/chatter", encode(String()))
    lcmtools.spin_once(node)
    (error,) = _errors(node)
    assert error.message == "String has no field 'dta' (fields: data); did you mean 'data'?"


def test_no_text_of_an_exception_keeps_a_node_from_being_announced(begin, bus):
    begin()
    node = Node("a")

    def fail(_):
        raise ValueError("\udcff" + "x" * 1000)

    node.create_subscription(String, "chatter", fail)
    bus.publish("/chatter", encode(String()))
    lcmtools.spin_once(node)
    (error,) = _errors(node)
    assert error.message.startswith("?x")
    assert len(error.message) == 200


def test_many_different_errors_are_bounded(begin, bus):
    begin()
    node = Node("a")
    program = "\n".join(f"def f{line}(_): raise ValueError" for line in range(200))
    names = {}
    exec(compile(program, "many.py", "exec"), names)  # noqa: S102 - the test's own text
    turns = iter(range(200))

    def fail(message):
        names[f"f{next(turns)}"](message)

    node.create_subscription(String, "chatter", fail)
    for _ in range(200):
        bus.publish("/chatter", encode(String()))
        lcmtools.spin_once(node)
    assert [error.place for error in _errors(node)] == [f"many.py:{n}" for n in range(196, 201)]


def test_without_a_frame_of_the_users_the_place_is_where_it_was_raised():
    assert place_of(ValueError(), print) == ("", 0, "")
    with pytest.raises(ValueError, match="Expecting") as raised:
        json.loads("{")
    assert place_of(raised.value, print)[0] == __file__
