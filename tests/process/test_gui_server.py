"""The window's server over a real bus, with pages that are no browsers."""

import itertools
import json
import threading
from contextlib import ExitStack, contextmanager

import pytest
from fixtures.says import assert_says

from lcmtools.gui import streams
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import OccupancyGrid
from lcmtools.types.rosgraph_msgs import Log
from lcmtools.types.sensor_msgs import CompressedImage
from lcmtools.types.std_msgs import String


def filled(kind, **values):
    """A message with some of its fields set."""
    return draft(kind, values).message


@contextmanager
def repeated(bus, topic, message):
    """Publish messages by their number until the block ends."""
    ends = threading.Event()

    def run():
        for number in itertools.count():
            bus.publish(topic, encode(message(number)))
            if ends.wait(0.01):
                return

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ends.set()
        thread.join()


@pytest.mark.parametrize(
    ("parameters", "problem"),
    [
        ({"topic": 7}, "'topic' is not a short text"),
        ({"topic": "x" * 2000}, "'topic' is not a short text"),  # pasted
        ({"topic": "\ud800"}, r"'\ud800' cannot be a channel's name"),
        ({"topic": "/a", "toggled": ["x"] * 2000}, "'toggled' is not a short list"),
    ],
)
def test_a_stream_that_cannot_be_opened_leaves_its_page_open(open_window, bus, parameters, problem):
    with open_window().page() as page, repeated(bus, "/a", lambda _: String()):
        page.open(1, "message", **parameters)
        assert page.problem(1) == problem
        page.open(2, "message", topic="\udcff")  # a channel that is no UTF-8
        page.open(3, "topics")
        assert page.data(3, lambda data: data["rows"])


def test_a_world_of_many_robots_is_drawn_and_too_many_are_said(open_window):
    with open_window().page() as page:
        for number in range(300):
            page.open(number, "newest", topic=f"/robot{number}/odometry")
        assert page.problem(299).startswith("there is no topic")
        page.open(300, "newest", topic="/robot300/odometry")
        assert_says(page.problem(300), "too much", "; close")


def test_topics_come_and_go_with_their_rates(open_window, bus):
    window = open_window()
    with window.page() as page:
        page.open(1, "topics")
        assert_says(page.problem(1), "no topics")
        with repeated(bus, "/chatter", lambda number: filled(String, data=f"{number}")):
            (row,) = page.data(1, lambda data: any(row["rate"] for row in data["rows"]))["rows"]
        assert (row["channel"], row["types"]) == ("/chatter", ["std_msgs/String"])


def test_a_message_is_decoded_with_its_lines(open_window, bus):
    window = open_window()
    with window.page() as page:
        page.open(3, "message", topic="/twist", toggled=["linear"])
        assert_says(page.problem(3), "no topic /twist; waiting")
        with repeated(bus, "/twist", lambda _: Twist()):
            data = page.data(3)
        assert data["type"] == "geometry_msgs/Twist"
        assert data["lines"][0] == ["linear", "linear", 0, "", 1, False]
        assert data["lines"][2] == ["angular.x", "x", 1, "0.0", 0, True]
        page.open(3, "message", topic="/twits")  # in its place
        hint = "there is no topic /twits; did you mean /twist?"  # once the table has /twist
        page.until(lambda frame: frame.get("id") == 3 and frame.get("problem") == hint)


def test_a_latched_message_comes_to_a_panel_that_is_opened_later(
    open_window, start, lcmtools_path, bus_url
):
    """The window subscribes to it already, so that its publisher does not send it again."""
    words = ("pub", "--latch", "/note", "std_msgs/String", "data: once")
    window = open_window()
    with window.page() as page:
        page.open(1, "topics")
        start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url).wait_for("latching")
        page.data(1, lambda rows: "/note" in json.dumps(rows))
        for number, topic in ((2, "/note"), (3, "note")):  # a slash may be missing
            page.open(number, "message", topic=topic)
            assert page.data(number)["lines"] == [["data", "data", 0, '"once"', 0, False]]


def test_a_large_message_that_was_said_once_is_shown_in_every_panel_later(open_window, bus):
    window = open_window()
    with window.page() as page:
        page.open(1, "topics")
        page.data(1)
        grid = filled(OccupancyGrid, data=[0] * 400_000)
        grid.info.width, grid.info.height, grid.info.resolution = 1000, 400, 0.05
        bus.publish("/map", encode(grid))
        page.data(1, lambda rows: "/map" in json.dumps(rows))
        page.open(2, "message", topic="/map")
        assert page.data(2)["size"] > 400_000
        page.open(3, "newest", topic="/map")
        found = page.until(lambda frame: frame.get("id") == 3 and "payload" in frame)
        assert found["width"] == 1000
    with window.page() as late:
        late.open(1, "message", topic="/map")
        assert late.data(1)["size"] > 400_000


def test_a_large_latched_message_comes_to_a_server_that_begins_later(
    open_window, start, lcmtools_path, bus_url
):
    words = ("pub", "--latch", "/note", "std_msgs/String", f"data: {'x' * 100_000}")
    start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url).wait_for("latching")
    for _ in range(2):
        window = open_window()
        with window.page() as page:
            page.open(1, "message", topic="/note")
            assert page.data(1)["size"] > 100_000
        window.end()


def test_large_messages_come_whole_and_what_is_no_message_as_bytes(open_window, bus):
    window = open_window()
    large = filled(CompressedImage, data=b"\7" * 300_000)
    with window.page() as page:
        page.open(1, "message", topic="LARGE")
        with repeated(bus, "LARGE", lambda _: large):
            found = page.data(1)
        page.open(2, "message", topic="RAW")
        page.problem(2)
        bus.publish("RAW", b"no message at all")
        raw = page.data(2)
        assert found["size"] > 300_000
        assert found["lines"][-1][3].startswith("uint8[300000] 07 07")
        assert bytes.fromhex(raw["bytes"]) == b"no message at all"


def line(number):
    return filled(Log, level=4, name="/a", msg=f"line {number}", file="a.py", line=7)


def test_log_lines_come_in_their_order(open_window, bus):
    window = open_window()
    with window.page() as page:
        page.open(1, "log")
        lines = []
        with repeated(bus, "/rosout", line):
            while len(lines) < 30:
                lines += page.data(1)["lines"]
        assert lines[0][1:3] == [4, "/a"]
        assert lines[0][4] == "a.py:7"
        numbers = [int(line[3].split()[1]) for line in lines]
        assert numbers == [*range(numbers[0], numbers[0] + len(numbers))]


def test_a_form_is_published_once_and_at_a_rate_until_it_is_closed(open_window, other, wait_until):
    window = open_window()
    came = []
    other.subscribe("/speed", lambda payload, _: came.append(payload))
    form = {"topic": "/speed", "type": "geometry_msgs/Twist", "values": {"linear": {"x": "0.5"}}}
    with window.page() as page:
        assert page.request("do", "publish", **form)["answer"] is None
        wait_until(lambda: came)
        assert Twist.decode(came[0]).linear.x == 0.5
        wrong = {**form, "values": {"linear": {"x": "fast"}}}
        assert "linear.x" in page.request("do", "publish", **wrong)["error"]["what"]
        assert (
            "Twits" in page.request("do", "publish", **{**form, "type": "Twits"})["error"]["what"]
        )
        page.open(5, "publishing", rate=100, **form)
        wait_until(lambda: len(came) > 10)
        page.open(6, "publishing", rate=100, **wrong)
        assert "linear.x" in page.problem(6)
    wait_until(lambda: "publishing" not in {thread.name for thread in threading.enumerate()})


def test_commands_that_waited_are_thrown_away(open_window, other, wait_until):
    window = open_window()
    came = []
    for topic in ("/speed", "/last"):
        other.subscribe(topic, lambda payload, _: came.append(Twist.decode(payload).linear.x))
    drive = {"op": "drive", "id": 1, "topic": "/speed", "type": "geometry_msgs/Twist", "turn": 0}
    form = {"type": "geometry_msgs/Twist", "values": {}}
    with window.page() as page:
        page.send(op="release", id=1, topic="/speed", sent=100.0)
        for number in range(20):  # as they come after a cut
            page.send(**drive, forward=0.5, sent=90.0 + number / 10)
        assert "too late" in page.data(1)["refused"]
        late = page.request("do", "publish", topic="/speed", sent=95.0, **form)
        assert "too late" in late["error"]["what"]
        page.open(3, "publishing", rate=100, topic="/speed", sent=95.0, **form)
        assert "too late" in page.problem(3)
        page.request("do", "publish", topic="/last", sent=100.1, **form)
        wait_until(lambda: came)
        assert came == [0.0]  # the one of /last


class Numbers(PageStream):
    """A stream of large frames that counts how often it is asked."""

    asked = 0
    period = 0.0

    def update(self):
        """Return the number of the call, and a lot of bytes."""
        Numbers.asked += 1
        return Update({"number": Numbers.asked}, bytes(1 << 20))


def test_a_page_that_does_not_read_holds_up_nothing_and_gets_the_newest_then(
    open_window, monkeypatch, wait_until
):
    monkeypatch.setitem(streams.STREAMS, "numbers", "none:Numbers")
    found = streams.stream_class
    monkeypatch.setattr(
        "lcmtools.gui.streams.stream_class",
        lambda name: Numbers if name == "numbers" else found(name),
    )
    monkeypatch.setattr(
        "lcmtools.gui.page.stream_class", lambda name: Numbers if name == "numbers" else found(name)
    )
    window = open_window()
    with window.page() as slow, window.page() as quick:
        slow.open(1, "numbers")
        wait_until(lambda: Numbers.asked > 1)
        before = -1
        while Numbers.asked > before:  # the connection's buffers fill, and then nothing is made
            before = Numbers.asked
            for _ in range(5):
                assert "answer" in quick.request("ask", "types")
        assert before < 40
        frames = [slow.frame() for _ in range(before + 3)]
        numbers = [frame["number"] for frame in frames if "number" in frame]
        assert numbers == [*range(1, len(numbers) + 1)]


def test_equal_streams_of_ten_pages_are_one(open_window, bus):
    window = open_window()
    with ExitStack() as stack:
        pages = [stack.enter_context(window.page()) for _ in range(10)]
        for page in pages:
            page.open(1, "topics")
        with repeated(bus, "/chatter", lambda _: filled(String, data="x")):
            for page in pages:
                assert page.data(1, lambda data: data["rows"])
        assert len(window.server._streams._shared) == 1
