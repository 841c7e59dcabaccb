"""A log in the window, without a browser: its time line, and the message of each time."""

import struct
import threading

import pytest
from fixtures.says import assert_line, assert_says
from fixtures.window import LiveWindow
from fixtures.wire import encode_event

from lcmtools.gui import log_source, playback
from lcmtools.gui.log_source import LogSource
from lcmtools.gui.streams import plot
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S


def _speed(value):
    twist = Twist()
    twist.linear.x = value
    return encode(twist)


@pytest.fixture
def log(tmp_path):
    """A log of two minutes: the time as a speed on /cmd each half second, and a /name at 1 s."""
    name = String()
    name.data = "cellar"
    packets = [Packet("/cmd", _speed(at / 2), START + at * S // 2) for at in range(241)]
    packets.insert(3, Packet("/name", encode(name), START + S))
    path = tmp_path / "a.log"
    path.write_bytes(b"".join(encode_event(n, one) for n, one in enumerate(packets)))
    return str(path)


@pytest.fixture
def page(log):
    """A page of the log, which stands still at its start."""
    window = LiveWindow(LogSource(log))
    with window.page() as opened:
        _play(opened, "pause")
        _play(opened, "seek", time=0)
        yield opened
    window.end()


def _play(page, action, **more):
    page.send(op="do", id=9, what="play", action=action, **more)


def _position(page, is_right):
    frame = page.until(lambda one: "state" in one and is_right(one["state"]["log"]))
    found = frame["state"]["log"]
    return found


def _value(data, path):
    return next((line[3] for line in data["lines"] if line[0] == path), "")


def test_a_log_may_be_played_and_not_commanded(page):
    assert (page.hello["source"], page.hello["rights"]) == ("log", ["watch", "play"])
    form = {"topic": "/a", "type": "std_msgs/String", "values": {"data": "x"}}
    error = page.request("do", "publish", **form)["error"]
    assert error["what"] == "a log takes no messages"


@pytest.mark.parametrize("time", [7.0, 100.2, 3.5, 0.0, 119.9])
def test_any_time_shows_the_message_of_that_time(page, time):
    page.open(1, "message", topic="/cmd")
    for there in (60.0, time):
        _play(page, "seek", time=there)
        wanted = str(float(there * 2 // 1 / 2))
        page.data(1, lambda data, wanted=wanted: _value(data, "linear.x") == wanted)


def test_actions_are_done_in_the_order_in_which_they_are_sent(page, monkeypatch):
    done = []
    is_done = threading.Event()  # the second one

    def play(_, *, action: str, time: float):
        assert action == "seek"
        if time == 1:
            is_done.wait(0.5)
        done.append(time)
        if time == 2:
            is_done.set()

    monkeypatch.setattr(playback, "play", play)
    for number in (1, 2):
        page.send(op="do", id=number, what="play", action="seek", time=number)
    page.until(lambda frame: frame.get("id") == 2 and "answer" in frame)
    assert done[-2:] == [1, 2]  # behind what the fixture has sent


def test_what_came_long_before_is_there(page):
    _play(page, "seek", time=90)
    page.open(1, "message", topic="/name")  # also where it is wanted only now
    page.data(1, lambda data: "cellar" in _value(data, "data"))
    page.open(2, "topics")
    rows = page.data(2, lambda data: any(row["rate"] for row in data["rows"]))["rows"]
    assert {row["channel"]: row["types"][0] for row in rows} == {
        "/cmd": "geometry_msgs/Twist",
        "/name": "std_msgs/String",
    }
    assert next(row["age"] for row in rows if row["channel"] == "/name") == pytest.approx(89)


def test_a_step_is_one_message(page):
    page.open(1, "message", topic="/cmd")
    _play(page, "seek", time=10)
    page.data(1, lambda data: _value(data, "linear.x") == "10.0")
    _play(page, "step")
    found = set()  # the message and the position, whichever comes first

    def are_there(frame):
        if frame.get("id") == 1 and _value(frame.get("data", {"lines": []}), "linear.x") == "10.5":
            found.add("message")
        if "state" in frame and frame["state"]["log"]["time"] == 10.5:
            assert frame["state"]["log"]["isPaused"]
            found.add("position")
        return len(found) == 2

    page.until(are_there)


def test_it_plays_at_a_rate_to_its_end_and_from_its_start(page):
    _play(page, "rate", rate=64)
    _play(page, "seek", time=100)
    _play(page, "play")
    assert _position(page, lambda log: log["isOver"])["time"] == pytest.approx(120, abs=0.6)
    _play(page, "rate", rate=0.25)
    _play(page, "play")
    assert _position(page, lambda log: not log["isOver"])["time"] < 100


def test_the_time_line_shows_gaps_by_its_histogram(page):
    about = page.request("ask", "timeline")["answer"]
    assert (about["start"], about["length"]) == (START / S, 120)
    assert sum(about["histogram"]) == 242
    assert about["losses"] == []


def test_a_plot_has_the_whole_log_wherever_it_is_played(page):
    _play(page, "seek", time=50)
    page.open(1, "plot", fields=["/cmd/linear.x"])
    frames = []
    while len(_samples(frames)) < 241:
        frames.append(page.until(lambda frame: frame.get("id") == 1))
    assert frames[0]["start"] == START / S
    assert _samples(frames) == [(START / S + at / 2, at / 2) for at in range(241)]
    assert not any("problem" in frame for frame in frames)


def test_of_a_long_log_each_nth_message_is_plotted(page, monkeypatch):
    monkeypatch.setattr(log_source, "_MOST_READ", 100)
    page.open(1, "plot", fields=["/cmd/linear.x"])
    frames = []
    while len(_samples(frames)) < 81:
        frames.append(page.until(lambda frame: frame.get("id") == 1))
    assert frames[0]["every"] == 3
    assert [value for _, value in _samples(frames)] == [at / 2 for at in range(0, 241, 3)]


def test_a_page_that_goes_ends_the_reading_of_a_log(page, monkeypatch):
    monkeypatch.setattr(plot, "_MOST_SAMPLES", 8)  # it waits for the page all the time
    page.open(1, "plot", fields=["/cmd/linear.x"])
    page.until(lambda frame: frame.get("payload"))
    page.send(op="close", id=1)
    assert page.request("ask", "timeline")["answer"]
    assert "plot of a log" not in [thread.name for thread in threading.enumerate()]


def _samples(frames):
    """The times and values of the first curve."""
    payload = b"".join(frame.get("payload", b"") for frame in frames)
    return [(time, value) for time, value, curve in struct.iter_unpack("<3d", payload)]


def test_rubbish_is_refused(page):
    assert "must be between" in page.request("do", "play", action="rate", rate=1e9)["error"]["what"]


def test_a_file_that_is_no_log_is_an_error(tmp_path, cli):
    path = tmp_path / "a.txt"
    path.write_text("hello")
    result = cli("gui", "--no-open", "--bag", str(path))
    assert result.code == 1
    assert_line(result.err, "lcmtools gui all: ", "no messages", f"{path}; ", "not an LCM log")
    result = cli("gui", "--bag", str(path), "--domain", "3")
    assert_says(result.err, "-b", "log", "bus")
