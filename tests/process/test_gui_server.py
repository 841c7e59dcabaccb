"""The window's server over a real bus, with pages that are no browsers."""

import itertools
import json
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from http.client import HTTPConnection
from typing import Any

import pytest
from fixtures.command import Result
from fixtures.programs import Program
from fixtures.says import assert_line, assert_says
from fixtures.window import LivePage, LiveWindow
from websockets.exceptions import ConnectionClosed, InvalidStatus

from lcmtools.bus.lcm_bus import LcmBus
from lcmtools.bus.url import parse_url
from lcmtools.errors import LcmtoolsError
from lcmtools.gui import streams
from lcmtools.gui.access import HEADERS, access_for
from lcmtools.gui.protocol import LONGEST_REQUEST
from lcmtools.gui.server import Server
from lcmtools.gui.source import BusSource
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.rosgraph_msgs import Log
from lcmtools.types.sensor_msgs import CompressedImage
from lcmtools.types.std_msgs import String

Open = Callable[..., LiveWindow]


@pytest.fixture
def open_window(bus_url: str) -> Iterator[Open]:
    """``open_window(host=None, read_only=False)``: a server on the test's bus."""
    windows: list[LiveWindow] = []

    def run(host: str | None = None, *, read_only: bool = False) -> LiveWindow:
        windows.append(LiveWindow(bus_url, host, read_only=read_only))
        return windows[-1]

    yield run
    for window in windows:
        window.end()


def get(window: LiveWindow, path: str, **headers: str) -> Any:
    connection = HTTPConnection("127.0.0.1", window.port, timeout=40)
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def filled(kind: type[Any], **values: Any) -> Any:
    """A message with some of its fields set."""
    return draft(kind, values).message


@contextmanager
def repeated(bus: LcmBus, topic: str, message: Callable[[int], Any]) -> Iterator[None]:
    """Publish messages by their number until the block ends."""
    ends = threading.Event()

    def run() -> None:
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
    "path", ["/", "/main.js", "/panels/topics.js", "/none", "/socket", "/%2e%2e/server.py"]
)
def test_every_answer_keeps_others_out(open_window: Open, path: str) -> None:
    window = open_window()
    response = get(window, path)
    assert response.status == {"/none": 404, "/%2e%2e/server.py": 404, "/socket": 403}.get(
        path, 200
    )
    assert {name: response.getheader(name) for name in HEADERS} == HEADERS
    assert response.getheader("Server") is None
    refused = get(window, path, Host="evil.example")
    assert (refused.status, refused.getheader("X-Frame-Options")) == (403, "DENY")


def test_no_file_outside_of_the_page_is_served(open_window: Open) -> None:
    window = open_window()
    for path in (
        "/../server.py",
        "//etc/passwd",
        "//[",
        "/panels/../../server.py",
        "/panels/",
        "/x\0.js",
    ):
        with socket.create_connection(("127.0.0.1", window.port)) as raw:
            raw.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
            assert raw.recv(15) == b"HTTP/1.1 404 No", path


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "http://127.0.0.1:1"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": None}, 403),
        ({"Host": "evil.example", "Origin": "http://evil.example"}, 403),
    ],
)
def test_a_page_of_others_gets_no_connection(
    open_window: Open, headers: dict[str, Any], status: int
) -> None:
    window = open_window()
    with pytest.raises(InvalidStatus) as caught:
        window.page(**headers)
    assert caught.value.response.status_code == status
    with window.page() as page:  # while its own is served
        assert page.hello["rights"] == ["watch", "command"]


def test_it_listens_on_this_computer_alone(open_window: Open) -> None:
    window = open_window()
    with pytest.raises(ConnectionRefusedError):  # as any other address of this computer
        socket.create_connection(("127.0.0.2", window.port)).close()


def test_a_token_gives_the_right_to_watch_or_to_command(open_window: Open) -> None:
    window = open_window("0.0.0.0")  # noqa: S104 - that is what is tested
    form = {"topic": "/a", "type": "std_msgs/String", "values": {"data": "x"}}
    assert get(window, "/").status == 403
    assert get(window, "/?token=" + "x" * 22).status == 403
    with pytest.raises(InvalidStatus):
        LivePage(f"http://127.0.0.1:{window.port}/?token=x")
    with window.page("watch") as page:
        assert page.hello["rights"] == ["watch"]
        page.open(1, "topics")
        assert_says(page.request("do", "publish", **form)["error"]["what"], "only watch")
        page.open(2, "publishing", rate=10, **form)
        assert_says(page.problem(2), "only watch")
    with window.page("command") as page:
        assert page.request("do", "publish", **form)["answer"] is None


def test_nobody_commands_a_read_only_window(open_window: Open) -> None:
    window = open_window(read_only=True)
    form = {"topic": "/a", "type": "std_msgs/String", "values": {"data": "x"}}
    with window.page() as page:
        assert page.hello["rights"] == ["watch"]
        assert "error" in page.request("do", "publish", **form)


@pytest.mark.parametrize(
    "rubbish",
    [
        "{",
        b"\0\1",
        "[]",
        '{"op": "explode"}',
        '{"op": "open", "id": 1, "stream": "none"}',
        '{"op": "ask", "id": 1, "what": "x"}',
    ],
)
def test_rubbish_closes_its_page_and_no_other_and_is_told_once(
    open_window: Open, rubbish: str | bytes, wait_until: Callable[..., None]
) -> None:
    window = open_window()
    with window.page() as other:
        for _ in range(2):
            with window.page() as page:
                page.socket.send(rubbish)
                with pytest.raises(ConnectionClosed) as caught:
                    page.until(lambda _: False)
            assert caught.value.rcvd is not None
            assert caught.value.rcvd.code == 1008
        assert "answer" in other.request("ask", "types")
    wait_until(lambda: window.told)
    assert len(window.told) == 1
    assert window.told[0].startswith("a page was closed: ")


def test_rubbish_behind_open_streams_closes_its_page_too(open_window: Open) -> None:
    window = open_window()
    for _ in range(10):  # in the turn in which the first stream wakes what writes
        with window.page() as page:
            page.open(1, "topics")
            page.open(2, "none")
            with pytest.raises(ConnectionClosed):
                page.until(lambda _: False)


@pytest.mark.parametrize(
    ("parameters", "problem"),
    [
        ({"topic": 7}, "'topic' is not a short text"),
        ({"topic": "x" * 2000}, "'topic' is not a short text"),  # pasted
        ({"topic": "\ud800"}, r"'\ud800' cannot be a channel's name"),
        ({"topic": "/a", "toggled": ["x"] * 2000}, "'toggled' is not a short list"),
    ],
)
def test_a_stream_that_cannot_be_opened_leaves_its_page_open(
    open_window: Open, bus: LcmBus, parameters: dict[str, Any], problem: str
) -> None:
    with open_window().page() as page, repeated(bus, "/a", lambda _: String()):
        page.open(1, "message", **parameters)
        assert page.problem(1) == problem
        page.open(2, "message", topic="\udcff")  # a channel that is no UTF-8
        page.open(3, "topics")
        assert page.data(3, lambda data: data["rows"])


def test_a_world_of_many_robots_is_drawn_and_too_many_are_said(open_window: Open) -> None:
    with open_window().page() as page:
        for number in range(300):
            page.open(number, "newest", topic=f"/robot{number}/odometry")
        assert page.problem(299).startswith("there is no topic")
        page.open(300, "newest", topic="/robot300/odometry")
        assert_says(page.problem(300), "too much", "; close")


def test_a_message_that_is_too_long_closes_its_page(open_window: Open) -> None:
    window = open_window()
    with window.page() as page:
        page.socket.send("x" * (LONGEST_REQUEST + 1))
        with pytest.raises(ConnectionClosed) as caught:
            page.until(lambda _: False)
        assert caught.value.rcvd is not None
        assert caught.value.rcvd.code == 1009


def test_topics_come_and_go_with_their_rates(open_window: Open, bus: LcmBus) -> None:
    window = open_window()
    with window.page() as page:
        page.open(1, "topics")
        assert_says(page.problem(1), "no topics")
        with repeated(bus, "/chatter", lambda number: filled(String, data=f"{number}")):
            (row,) = page.data(1, lambda data: any(row["rate"] for row in data["rows"]))["rows"]
        assert (row["channel"], row["types"]) == ("/chatter", ["std_msgs/String"])


def test_a_message_is_decoded_with_its_lines(open_window: Open, bus: LcmBus) -> None:
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
    open_window: Open, start: Callable[..., Program], lcmtools_path: str, bus_url: str
) -> None:
    """The window subscribes to it already, so that its publisher does not send it again."""
    words = ("pub", "--latch", "/note", "std_msgs/String", "data: once")
    window = open_window()
    with window.page() as page:
        page.open(1, "topics")
        start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url).wait_for("latching")
        page.data(1, lambda rows: "/note" in json.dumps(rows))
        for number in (2, 3):
            page.open(number, "message", topic="/note")
            assert page.data(number)["lines"] == [["data", "data", 0, '"once"', 0, False]]


def test_large_messages_come_whole_and_what_is_no_message_as_bytes(
    open_window: Open, bus: LcmBus
) -> None:
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


def line(number: int) -> Log:
    return filled(Log, level=4, name="/a", msg=f"line {number}", file="a.py", line=7)


def test_log_lines_come_in_their_order(open_window: Open, bus: LcmBus) -> None:
    window = open_window()
    with window.page() as page:
        page.open(1, "log")
        lines: list[Any] = []
        with repeated(bus, "/rosout", line):
            while len(lines) < 30:
                lines += page.data(1)["lines"]
        assert lines[0][1:3] == [4, "/a"]
        assert lines[0][4] == "a.py:7"
        numbers = [int(line[3].split()[1]) for line in lines]
        assert numbers == [*range(numbers[0], numbers[0] + len(numbers))]


def test_a_form_is_published_once_and_at_a_rate_until_it_is_closed(
    open_window: Open, other: LcmBus, wait_until: Callable[..., None]
) -> None:
    window = open_window()
    came: list[bytes] = []
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


class Numbers(PageStream):
    """A stream of large frames that counts how often it is asked."""

    asked = 0
    period = 0.0

    def update(self) -> Update:
        """Return the number of the call, and a lot of bytes."""
        Numbers.asked += 1
        return Update({"number": Numbers.asked}, bytes(1 << 20))


def test_a_page_that_does_not_read_holds_up_nothing_and_gets_the_newest_then(
    open_window: Open, monkeypatch: pytest.MonkeyPatch, wait_until: Callable[..., None]
) -> None:
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


def test_equal_streams_of_ten_pages_are_one(open_window: Open, bus: LcmBus) -> None:
    window = open_window()
    with ExitStack() as stack:
        pages = [stack.enter_context(window.page()) for _ in range(10)]
        for page in pages:
            page.open(1, "topics")
        with repeated(bus, "/chatter", lambda _: filled(String, data="x")):
            for page in pages:
                assert page.data(1, lambda data: data["rows"])
        assert len(window.server._streams._shared) == 1


def test_ctrl_c_tells_all_pages_and_ends(
    start: Callable[..., Program], lcmtools_path: str, bus_url: str
) -> None:
    program = start(
        lcmtools_path, "gui", "--port", "0", "--no-open", "--json", LCM_DEFAULT_URL=bus_url
    )
    program.wait_for("}")
    address = json.loads(program.output)["command"]
    with LivePage(address) as page:
        program.send_signal(signal.SIGINT)
        with pytest.raises(ConnectionClosed) as caught:
            page.until(lambda _: False)
        assert caught.value.rcvd is not None
        assert caught.value.rcvd.code == 1001
    assert program.wait() == 128 + signal.SIGINT


def test_a_signal_waits_for_the_step_that_the_server_does(bus_url: str) -> None:
    """Within asyncio, an interrupt can leave a connection half closed, which never ends."""
    done: list[int] = []

    def start(port: int) -> None:
        signal.raise_signal(signal.SIGINT)
        done.append(port)

    before = signal.getsignal(signal.SIGINT)
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor, closing(BusSource(monitor)) as bus:
        server = Server(bus, access_for(None), {}, lambda _: None)
        with pytest.raises(KeyboardInterrupt):
            server.run_until_interrupted("127.0.0.1", 0, start)
    assert len(done) == 1
    assert signal.getsignal(signal.SIGINT) is before


def test_a_server_on_a_thread_ends_with_its_block_and_raises_where_it_begins(
    bus_url: str,
) -> None:
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor, closing(BusSource(monitor)) as bus:
        server = Server(bus, access_for(None), {}, lambda _: None)
        with server.serving("127.0.0.1", 0) as port:
            with (
                pytest.raises(LcmtoolsError, match=f"port {port} is in use"),
                server.serving("127.0.0.1", port),
            ):
                pass
            assert LivePage(f"http://127.0.0.1:{port}/").hello["source"] == "bus"
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", port))
    assert "pages" not in {thread.name for thread in threading.enumerate()}


def test_a_port_in_use_is_an_error_with_the_next_step(
    cli: Callable[..., Result], bus_url: str
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = cli("gui", "--port", str(port), "--no-open", "--lcm-url", bus_url)
    assert (result.code, result.out) == (1, "")
    parts = (f"port {port}", "in use; ", f"http://127.0.0.1:{port}; ", f"--port {port + 1}\n")
    assert_line(result.err, "lcmtools gui all: ", *parts)


def test_an_address_of_another_computer_is_an_error(
    cli: Callable[..., Result], bus_url: str
) -> None:
    result = cli("gui", "--host", "192.0.2.1", "--port", "0", "--no-open", "--lcm-url", bus_url)
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert_says(result.err, "lcmtools gui all: ", "cannot listen", "192.0.2.1: ")


def test_the_extra_is_named_where_it_is_missing(
    cli: Callable[..., Result], bus_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "lcmtools.gui.server", raising=False)
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    result = cli("gui", "topics", "--lcm-url", bus_url)
    assert (result.code, result.out, result.err.count("\n")) == (3, "", 1)
    assert "pip install 'lcmtools-robotics[web]'" in result.err


def test_two_addresses_are_told_where_others_may_watch(
    cli: Callable[..., Result], bus_url: str
) -> None:
    arguments = ("--host", "127.0.0.2", "--port", "0", "--no-open", "--lcm-url", bus_url)
    result = cli("gui", *arguments, until="Ctrl-C ends it")
    watch, command, _ = result.err.splitlines()
    assert watch.startswith("to watch: http://127.0.0.2:")
    assert command.startswith("to command: http://127.0.0.2:")
    assert watch.partition("?token=")[2] != command.partition("?token=")[2]
