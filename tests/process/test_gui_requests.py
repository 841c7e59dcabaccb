"""Requests of pages to nodes: services, parameters and recordings, over a real bus."""

import math
import threading
import time

import pytest
from fixtures.says import assert_says

import lcmtools
from lcmtools import Node
from lcmtools.bag.writer import LogWriter
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import PoseStamped, PoseWithCovarianceStamped
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import SetBool, Trigger


class Server(Node):
    """A node with services and parameters."""

    def __init__(self):
        super().__init__("server")
        self.received = []
        self.goes_on = threading.Event()
        self.create_service(SetBool, "switch", self._switch)
        self.create_service(Trigger, "stuck", self._be_stuck)
        self.create_service(Trigger, "broken", self._fail)
        self.declare_parameter("gain", 1.0, "effort", minimum=0.0, maximum=10.0)
        self.declare_parameter("model", "husky", read_only=True)

    def _switch(self, request, response):
        self.received.append(request.data)
        response.success, response.message = request.data, "switched"
        return response

    def _be_stuck(self, _, response):
        self.goes_on.wait(40)
        return response

    def _fail(self, _request, _response):
        raise RuntimeError("no power")


@pytest.fixture
def server(start_node):
    """A node on the test's bus, which leaves with the test."""
    node = start_node(Server).node
    yield node
    node.goes_on.set()


@pytest.fixture
def page(open_window, server):  # noqa: ARG001 - it runs
    """A page that sees the node."""
    with open_window().page() as opened:
        opened.open(1, "offers")
        opened.data(1, lambda data: "/server" in data["nodes"])
        yield opened


def call(page, service, **options):
    """Call a service by the form of its request; return the answer's frame."""
    kind = "SetBool" if service == "/switch" else "Trigger"
    usual = {"type": f"std_srvs/{kind}_Request", "values": {}}
    return page.request("do", "call", service=service, **{**usual, **options})


def test_services_and_nodes_with_parameters_are_offered(page):
    page.open(2, "offers")
    data = page.data(2)
    assert {"name": "/switch", "types": ["std_srvs/SetBool"], "nodes": ["/server"]} in (
        data["services"]
    )
    assert not [one for one in data["services"] if "_parameters" in one["name"]]


def test_a_service_is_called_and_its_answer_unfolds(page, server):
    answer = call(page, "/switch", values={"data": True})["answer"]
    assert server.received == [True]
    assert answer["failure"] == ""
    page.open(2, "answer", number=answer["number"], toggled=[])
    data = page.data(2)
    assert data["type"] == "std_srvs/SetBool_Response"
    assert [line[:4] for line in data["lines"]] == [
        ["success", "success", 0, "true"],
        ["message", "message", 0, '"switched"'],
    ]
    failed = call(page, "/switch")["answer"]
    assert failed["failure"] == "it reports a failure: switched"
    page.open(3, "answer", number=failed["number"] + 1)
    assert "no longer kept" in page.problem(3)


@pytest.mark.parametrize(
    ("service", "options", "words"),
    [
        ("/switch", {"values": {"data": "perhaps"}}, ["data", "perhaps"]),
        ("/switch", {"type": "std_srvs/Trigger_Request"}, ["std_srvs/SetBool_Request"]),
        ("/swich", {}, ["/swich"]),
        ("/broken", {}, ["no power"]),
        ("/stuck", {"deadline": 0.05}, ["did not answer within 0.05 s"]),
        ("/switch", {"deadline": 1e9}, ["'deadline'"]),
        ("", {}, ["name is empty"]),
    ],
)
def test_a_call_that_fails_says_why(page, server, service, options, words):
    assert_says(call(page, service, **options)["error"]["what"], *words)
    server.goes_on.set()
    assert server.received == []


@pytest.mark.usefixtures("server")
def test_a_server_that_ends_waits_for_no_service(open_window):
    window = open_window()
    with window.page() as page:
        page.open(1, "offers")
        page.data(1, lambda data: data["services"])
        request = {"service": "/stuck", "type": "std_srvs/Trigger_Request", "values": {}}
        page.send(op="do", id=5, what="call", deadline=30, **request)
        page.request("ask", "types")  # the call has been begun
        start = time.monotonic()
        window.end()
    assert time.monotonic() - start < 20


def test_parameters_are_read_and_set_with_the_answer_of_the_node(page):
    def values(frame):
        return {one["name"]: one["value"] for one in frame["answer"]}

    found = page.request("ask", "node-parameters", node="/server")["answer"]
    assert found[0] == {
        "node": "/server",
        "name": "gain",
        "type": "float",
        "value": "1.0",
        "description": "effort",
        "minimum": "0.0",
        "maximum": "10.0",
        "read_only": False,
    }
    assert found[1]["read_only"] is True
    change = {"node": "/server", "name": "gain"}
    assert values(page.request("do", "set-parameter", **change, value="2.5"))["gain"] == "2.5"
    refused = page.request("do", "set-parameter", **change, value="99")["error"]["what"]
    assert_says(refused, "gain", "10.0")
    unknown = page.request("do", "set-parameter", **{**change, "name": "gian"}, value="1")
    assert "gian" in unknown["error"]["what"]
    assert values(page.request("ask", "node-parameters", node="/server"))["gain"] == "2.5"
    assert "/nobody" in page.request("ask", "node-parameters", node="/nobody")["error"]["what"]


@pytest.mark.parametrize("what", ["call", "set-parameter", "record", "stop-recording"])
def test_a_page_that_may_only_watch_commands_no_node(open_window, tmp_path, what):
    window = open_window(read_only=True, directory=tmp_path)
    with window.page() as page:
        refused = page.request("do", what, node="/server", service="/switch", topics=[])
    assert refused["error"]["what"] == "this page may only watch, not command"
    assert list(tmp_path.iterdir()) == []


def recorded(directory):
    """Return the texts in the only log of a directory."""
    [path] = directory.glob("*.lcmlog")
    with lcmtools.bag.open(path) as log:
        return [arrival.message.data for arrival in log.messages("/chatter")]


def publish(bus, page, number):
    """Publish until the recording that the page sees has a message."""
    text = String()
    text.data = "hello"
    while True:
        bus.publish("/chatter", encode(text))
        bus.publish("/other", encode(text))
        data = page.data(number, lambda data: "topics" in data)
        if not data["told"].startswith("0 "):
            return


def test_a_recording_counts_and_its_file_is_finished(open_window, bus, tmp_path):
    directory = tmp_path / "100%d"
    directory.mkdir()
    with open_window(directory=directory).page() as page:
        page.open(1, "recording")
        assert page.request("do", "record", topics=["/chatter"])["answer"] is None
        publish(bus, page, 1)
        page.open(2, "recording")
        assert page.data(2)["topics"] == ["/chatter"]
        again = page.request("do", "record", topics=[])["error"]
        assert (again["what"], again["hint"]) == ("a recording is running already", "stop it first")
        told = page.request("do", "stop-recording")["answer"]
        assert_says(told, " in ", str(directory), ".lcmlog; no losses")
        assert page.data(1, lambda data: "topics" not in data)["told"] == told
    texts = recorded(directory)
    assert texts
    assert set(texts) == {"hello"}
    with lcmtools.bag.open(next(directory.glob("*.lcmlog"))) as log:
        assert list(log.topics) == ["/chatter"]


def test_a_server_that_ends_finishes_its_recording(open_window, bus, tmp_path):
    window = open_window(directory=tmp_path)
    with window.page() as page:
        page.open(1, "recording")
        page.request("do", "record", topics=["/chatter"])
        publish(bus, page, 1)
    window.end()
    assert recorded(tmp_path)
    assert list(tmp_path.glob("*.index")) or list(tmp_path.glob(".*"))


def test_a_full_disk_ends_a_recording_and_is_said(open_window, bus, tmp_path, monkeypatch):
    def fail(*_):
        raise LcmtoolsError("cannot write: No space left on device")

    with open_window(directory=tmp_path).page() as page:
        page.request("do", "record", topics=[])
        monkeypatch.setattr(LogWriter, "write", fail)
        page.open(1, "recording")
        data = {"topics": []}
        while "topics" in data:
            bus.publish("/chatter", encode(String()))
            data = page.data(1)
        assert_says(data["told"], str(tmp_path))
        assert data["fault"] == "cannot write: No space left on device"
        monkeypatch.undo()
        assert "answer" in page.request("do", "stop-recording")


def test_a_working_directory_that_is_gone_is_said(open_window, tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with open_window().page() as page:
        error = page.request("do", "record", topics=[])["error"]
    assert_says(error["what"], "working directory", "gone")
    assert_says(error["hint"], "--record-directory")


def test_a_directory_that_cannot_be_written_is_said(open_window, tmp_path):
    with open_window(directory=tmp_path / "gone").page() as page:
        error = page.request("do", "record", topics=["../../etc/passwd"])["error"]["what"]
        assert_says(error, "gone", "No such file")
        page.open(1, "recording")
        assert page.data(1)["told"] == ""


@pytest.mark.parametrize("kind", [PoseStamped, PoseWithCovarianceStamped])
def test_a_pose_has_the_type_that_nodes_of_its_topic_announce(
    open_window, start_node, wait_until, kind
):
    came = []

    def make():
        node = Node("amcl")
        node.create_subscription(kind, "/initialpose", came.append)
        return node

    start_node(make)
    with open_window().page() as page:
        page.open(1, "offers")
        page.data(1, lambda data: "/initialpose" in data["topics"])
        pose = {"x": 1.0, "y": -2.0, "qz": 0.6, "qw": 0.8}
        page.request("do", "send-pose", topic="/initialpose", frame="map", **pose)
        wait_until(lambda: came)
    message = came[0]
    assert message.header.frame_id == "map"
    found = message.pose
    if kind is PoseWithCovarianceStamped:
        found = message.pose.pose
        covariance = message.pose.covariance
        assert covariance[0] == covariance[7] == 0.25  # [m^2]
        assert covariance[35] == pytest.approx(math.radians(15) ** 2)
        assert sum(covariance) == pytest.approx(0.5 + covariance[35])
    assert (found.position.x, found.position.y, found.orientation.z) == (1.0, -2.0, 0.6)
