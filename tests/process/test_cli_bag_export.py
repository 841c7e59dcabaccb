"""bag export and import: a log in other formats, and back."""

import json

import lcm
import numpy as np
import pytest
from fixtures.says import assert_says

from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String


@pytest.fixture
def log(tmp_path):
    """The path of a log: /cmd and /chatter once a second, and a hidden topic."""
    path = str(tmp_path / "a.lcmlog")
    log = lcm.EventLog(path, "w", overwrite=True)
    for number in range(10):
        twist, text = Twist(), String()
        twist.linear.x, text.data = number / 4, f"message {number}"
        time = 1_000_000 * (100 + number)
        log.write_event(time, "/cmd", encode(twist))
        log.write_event(time + 1, "/chatter", encode(text))
        log.write_event(time + 2, "/_hidden", encode(text))
    log.close()
    return path


def test_topics_and_times_are_chosen(log, tmp_path, cli):
    target = tmp_path / "a.npz"
    words = ("bag", "export", log, str(target), "-t", "/cmd", "-s", "2s", "-e", "end-2s")
    assert cli(*words).out == f"{target}: 6 messages\n"
    assert np.load(target)["linear.x"].tolist() == [number / 4 for number in range(2, 8)]


def test_hidden_topics_are_left_out_unless_they_are_named(log, tmp_path, cli):
    topics = []
    for name, choice in (("a.jsonl", ()), ("b.jsonl", ("-t", "/_hidden"))):
        assert cli("bag", "export", log, str(tmp_path / name), *choice).code == 0
        lines = (tmp_path / name).read_text().splitlines()
        topics.append({json.loads(line)["topic"] for line in lines})
    assert topics == [{"/cmd", "/chatter"}, {"/_hidden"}]


@pytest.mark.parametrize(
    ("target", "options"),
    [("a.mcap", ()), ("a.bag", ()), ("folder", ("--format", "ros2"))],
)
def test_a_log_comes_back_from_ros_as_it_went(target, options, log, tmp_path, cli):
    there, back = str(tmp_path / target), str(tmp_path / "back.lcmlog")
    assert cli("bag", "export", log, there, *options).code == 0
    result = cli("bag", "import", there, back, "--json")
    assert json.loads(result.out)["messages"] == 20
    printed = [cli("echo", "-b", file, "/cmd", "/chatter").out for file in (log, back)]
    assert printed[0] == printed[1]
    assert "message 9" in printed[0]


def test_what_is_left_out_is_said(tmp_path, cli):
    path, target = tmp_path / "a.lcmlog", tmp_path / "a.jsonl"
    log = lcm.EventLog(str(path), "w", overwrite=True)
    log.write_event(1_000_000, "/chatter", encode(String()))
    log.write_event(1_000_001, "/x", b"12345678")
    log.close()
    result = cli("bag", "export", str(path), str(target))
    assert (result.code, result.out) == (1, f"{target}: 1 message\n")
    (line,) = result.err.splitlines()
    assert_says(line, "/x", "left out", "0x3132333435363738")
