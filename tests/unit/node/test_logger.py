"""A node's log, to standard error and to /rosout."""

import io
import re

import pytest
from fixtures.says import assert_says

import lcmtools
from lcmtools import Node
from lcmtools.clock import ManualClock
from lcmtools.escapes import ESCAPES_IN_LINES
from lcmtools.messages.codec import decode
from lcmtools.node.logger import Logger
from lcmtools.types.rosgraph_msgs import Log


class _Desk:
    """A logger with what it prints and forwards."""

    def __init__(self):
        self.stream = io.StringIO()
        self.entries = []
        self.clock = ManualClock(1_700_000_000_000_000_042)
        self.logger = Logger("/husky0/driver", self.clock, self.entries.append, self.stream)

    @property
    def lines(self):
        return self.stream.getvalue().splitlines()


@pytest.fixture
def desk():
    return _Desk()


def test_a_line_looks_as_in_ros(desk):
    desk.logger.info("hello")
    assert desk.stream.getvalue() == "[INFO] [1700000000.000000042] [/husky0/driver]: hello\n"


@pytest.mark.parametrize(
    ("method", "label", "severity"),
    [("info", "INFO", 2), ("warning", "WARN", 4), ("error", "ERROR", 8), ("fatal", "FATAL", 16)],
)
def test_each_severity_is_labelled(desk, method, label, severity):
    getattr(desk.logger, method)("x")
    assert desk.lines[0].startswith(f"[{label}] [")
    assert desk.entries[0].level == severity


def test_debug_is_forwarded_and_printed_on_demand(desk):
    desk.logger.debug("quiet")
    assert desk.lines == []
    assert [entry.level for entry in desk.entries] == [Log.DEBUG]
    desk.logger.threshold = Log.DEBUG
    desk.logger.debug("loud")
    assert desk.lines == ["[DEBUG] [1700000000.000000042] [/husky0/driver]: loud"]


def test_an_entry_knows_where_it_was_logged(desk):
    desk.logger.warning("x")
    (entry,) = desk.entries
    assert entry.file == "test_logger.py"
    assert entry.function == "test_an_entry_knows_where_it_was_logged"
    assert entry.line > 0


def test_once_is_once_for_each_place(desk):
    for number in range(3):
        desk.logger.info(f"here {number}", once=True)
        desk.logger.info(f"there {number}", once=True)
    assert [line.partition(": ")[2] for line in desk.lines] == ["here 0", "there 0"]
    assert len(desk.entries) == 2


def test_a_throttled_place_waits_its_period(desk, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("lcmtools.node.logger.time.monotonic", lambda: now[0])
    for tenth in range(30):
        now[0] = 100.0 + tenth / 10
        desk.logger.info(f"{tenth}", throttle=1.0)
        desk.logger.info("always")
    printed = [line.partition(": ")[2] for line in desk.lines]
    assert [text for text in printed if text != "always"] == ["0", "10", "20"]
    assert printed.count("always") == 30


def test_a_line_of_several_is_one_entry(desk):
    desk.logger.error("a\nb")
    assert desk.stream.getvalue().endswith(": a\nb\n")
    assert [entry.msg for entry in desk.entries] == ["a\nb"]


def test_text_of_a_message_cannot_control_the_terminal(desk):
    desk.logger.info("Hellö 你\t\x1b[2J\u202e")
    assert desk.stream.getvalue().endswith(": Hellö 你\t\\x1b[2J\\u202e\n")
    assert [entry.msg for entry in desk.entries] == ["Hellö 你\t\x1b[2J\u202e"]


def test_a_nodes_log_goes_to_standard_error_and_rosout(begin, bus, capsys):
    begin("__ns:=/husky0")
    node = Node("driver")
    node.get_logger().warning("low battery")
    printed = capsys.readouterr()
    assert printed.out == ""
    match = re.fullmatch(
        r"\[WARN\] \[(\d+)\.(\d{9})\] \[/husky0/driver\]: low battery\n", printed.err
    )
    assert match
    (entry,) = [decode(Log, payload) for channel, payload in bus.published if channel == "/rosout"]
    assert (entry.header.stamp.sec, entry.header.stamp.nsec) == tuple(map(int, match.groups()))
    assert (entry.level, entry.name, entry.msg) == (Log.WARN, "/husky0/driver", "low battery")
    assert (entry.file, entry.line > 0) == ("test_logger.py", True)
    assert entry.function == "test_a_nodes_log_goes_to_standard_error_and_rosout"


def test_a_tools_log_stays_off_the_bus(begin, bus):
    begin()
    Node("a", tool=True).get_logger().info("x")
    assert "/rosout" not in [channel for channel, _ in bus.published]


@pytest.mark.parametrize("text", ["file \udcff", "a\0b", "\ud800", "☃" * 1000, 42, None])
def test_no_text_is_an_error_to_log(begin, bus, text):
    begin()
    logger = Node("a").get_logger()
    logger._stream = io.StringIO()
    logger.info(text)
    assert logger._stream.getvalue().endswith(f"{str(text).translate(ESCAPES_IN_LINES)}\n")
    assert "/rosout" in [channel for channel, _ in bus.published]


def test_a_log_after_the_end_is_printed(begin, capsys):
    context = begin()
    node = Node("a")
    context.close()
    node.get_logger().info("goodbye")
    assert capsys.readouterr().err.endswith("[/a]: goodbye\n")


def test_a_misspelt_parameter_is_a_warning_when_the_node_spins(begin, capsys):
    context = begin("_gian:=2.0", "_gain:=1.0")
    node = Node("a")
    node.declare_parameter("gain", 0.0)
    context.stop()
    lcmtools.spin(node)
    log = capsys.readouterr().err
    assert log.count("\n") == 1
    assert_says(log, "no parameter 'gian'", "did you mean gain?")


def test_a_log_whose_stream_was_closed_raises_nothing(desk):
    desk.stream.close()
    desk.logger.info("hello")
    assert [entry.msg for entry in desk.entries] == ["hello"]
