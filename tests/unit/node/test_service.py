"""Services: each request is answered once, whatever gets lost, and failures reach the caller."""

import threading
import time
from collections.abc import Callable, Iterator

import pytest

import lcmtools
from lcmtools import Node
from lcmtools.bus.base import FakeBus
from lcmtools.errors import BusError, InvalidName, LcmtoolsError, ServiceError, ValueMismatch
from lcmtools.graph.model import Role
from lcmtools.messages.codec import decode, encode
from lcmtools.node.context import Context
from lcmtools.node.service import Client, reply_channel, request_channel
from lcmtools.types.lcmtools_msgs import ServiceReply, ServiceRequest
from lcmtools.types.std_msgs import Int32
from lcmtools.types.std_srvs import SetBool, Trigger

Begin = Callable[..., Context]
Serve = Callable[[Node], None]


class _Lossy(FakeBus):
    """A bus that loses the first messages of a channel."""

    def __init__(self, channel: str, count: int = 1) -> None:
        super().__init__()
        self.left = count
        self._channel = channel

    def publish(self, channel: str, payload: bytes) -> None:
        if channel == self._channel and self.left > 0:
            self.left -= 1
            return
        super().publish(channel, payload)


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Spins a node on a thread of its own until the test ends."""
    stop = threading.Event()
    threads: list[threading.Thread] = []

    def spin(node: Node) -> None:
        while not stop.is_set():
            node.run_ready()
            time.sleep(0.001)

    def start(node: Node) -> None:
        threads.append(threading.Thread(target=spin, args=[node]))
        threads[-1].start()

    yield start
    stop.set()
    for thread in threads:
        thread.join()


@pytest.fixture
def logged(capsys: pytest.CaptureFixture[str]) -> Callable[[str], bool]:
    """Whether a text has been logged so far; a server logs after it has replied."""
    log: list[str] = []

    def is_logged(text: str) -> bool:
        log.append(capsys.readouterr().err)
        return text in "".join(log)

    return is_logged


class _Server:
    """A node with the service /switch, which repeats what it is told."""

    def __init__(self) -> None:
        self.node = Node("server")
        self.calls: list[bool] = []
        self.node.create_service(SetBool, "switch", self._answer)

    def _answer(
        self, request: SetBool.Request, response: SetBool.Response
    ) -> SetBool.Response:
        self.calls.append(request.data)
        response.success, response.message = request.data, f"call {len(self.calls)}"
        return response


def _request(*, data: bool = True) -> SetBool.Request:
    request = SetBool.Request()
    request.data = data
    return request


def test_a_request_is_answered(begin: Begin, serve: Serve) -> None:
    begin()
    server = _Server()
    serve(server.node)
    client = Node("client").create_client(SetBool, "switch")
    for data in (True, False):
        response = client.call(_request(data=data))
        assert isinstance(response, SetBool.Response)
        assert response.success is data
    assert server.calls == [True, False]
    assert response.message == "call 2"


def test_a_lost_request_is_sent_again_and_answered_once(begin: Begin, serve: Serve) -> None:
    begin(bus=_Lossy(request_channel("/switch")))
    server = _Server()
    serve(server.node)
    before = time.monotonic()
    response = Node("client").create_client(SetBool, "switch").call(_request(), timeout=5.0)
    assert time.monotonic() - before < 2.0
    assert response.message == "call 1"
    assert server.calls == [True]


def test_a_lost_reply_is_sent_again_without_a_second_call(begin: Begin, serve: Serve) -> None:
    begin(bus=_Lossy(reply_channel("/switch"), 2))
    server = _Server()
    serve(server.node)
    response = Node("client").create_client(SetBool, "switch").call(_request(), timeout=5.0)
    assert response.message == "call 1"
    assert server.calls == [True]


def test_a_slow_service_is_called_once(begin: Begin, serve: Serve) -> None:
    begin()
    node, calls = Node("server"), []

    def slow(_request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        calls.append(1)
        time.sleep(0.6)  # over two retries
        return response

    node.create_service(Trigger, "slow", slow)
    serve(node)
    client = Node("client").create_client(Trigger, "slow")
    client.call(Trigger.Request(), timeout=5.0)
    assert calls == [1]
    client.call(Trigger.Request(), timeout=5.0)
    assert calls == [1, 1]


def test_no_answer_is_an_error_in_time(begin: Begin) -> None:
    begin()
    client = Node("client").create_client(Trigger, "/nobody")
    before = time.monotonic()
    with pytest.raises(ServiceError, match=r"/nobody did not answer within 0\.1 s") as caught:
        client.call(Trigger.Request(), timeout=0.1)
    assert time.monotonic() - before < 0.5
    assert "lcmtools node list" in caught.value.hint


def test_a_service_that_raises_fails_the_call_and_its_node_goes_on(
    begin: Begin, serve: Serve, logged: Callable[[str], bool], wait_until: Callable[..., None]
) -> None:
    begin()
    node = Node("server")

    def fail(_request: Trigger.Request, _response: Trigger.Response) -> Trigger.Response:
        raise RuntimeError("no power")

    node.create_service(Trigger, "fail", fail)
    server = _Server()
    serve(node)
    serve(server.node)
    client = Node("client")
    with pytest.raises(ServiceError, match=r"/fail: RuntimeError\('no power'\)"):
        client.create_client(Trigger, "fail").call(Trigger.Request())
    assert client.create_client(SetBool, "switch").call(_request()).success
    wait_until(lambda: logged("service /fail raised RuntimeError: no power\nTraceback"))


def test_an_error_for_the_caller_is_passed_on_without_a_traceback(
    begin: Begin, serve: Serve, capsys: pytest.CaptureFixture[str]
) -> None:
    begin()
    node = Node("server")

    def refuse(_request: Trigger.Request, _response: Trigger.Response) -> Trigger.Response:
        raise LcmtoolsError("the robot is not enabled", "enable it first")

    node.create_service(Trigger, "go", refuse)
    serve(node)
    client = Node("client").create_client(Trigger, "go")
    with pytest.raises(ServiceError, match="/go: the robot is not enabled; enable it first"):
        client.call(Trigger.Request())
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("answer", [None, "text", Int32(), Trigger.Request()])
def test_a_service_that_returns_no_response_fails_the_call(
    begin: Begin, serve: Serve, answer: object
) -> None:
    begin()
    node = Node("server")
    node.create_service(Trigger, "odd", lambda _request, _response: answer)  # type: ignore[arg-type,return-value]
    serve(node)
    client = Node("client").create_client(Trigger, "odd")
    with pytest.raises(ServiceError, match="/odd: .*std_srvs/Trigger_Response"):
        client.call(Trigger.Request(), timeout=5.0)


def test_a_request_of_another_type_fails_the_call(begin: Begin, serve: Serve) -> None:
    begin()
    server = _Server()
    serve(server.node)
    client = Node("client").create_client(Trigger, "switch")
    with pytest.raises(ServiceError, match="/switch: .*std_srvs/SetBool_Request"):
        client.call(Trigger.Request())
    with pytest.raises((ServiceError, ValueMismatch)):
        client.call(Int32())  # type: ignore[arg-type]
    assert server.calls == []


def test_a_value_that_does_not_fit_is_refused_before_it_is_sent(begin: Begin) -> None:
    begin()
    client = Node("client").create_client(SetBool, "switch")
    request = SetBool.Request()
    request.data = "maybe"  # type: ignore[assignment]
    with pytest.raises(ValueMismatch, match="data"):
        client.call(request)


def test_a_client_may_call_inside_a_callback(begin: Begin, bus: FakeBus, serve: Serve) -> None:
    begin()
    server = _Server()
    serve(server.node)
    node, answers = Node("caller"), []
    client = node.create_client(SetBool, "switch")
    node.create_subscription(
        Int32, "ask", lambda _: answers.append(client.call(_request()).message)
    )
    bus.publish("/ask", encode(Int32()))
    lcmtools.spin_once(node)
    assert answers == ["call 1"]


def test_a_call_of_ones_own_service_inside_a_callback_times_out_and_nothing_worse(
    begin: Begin, bus: FakeBus
) -> None:
    begin()
    server = _Server()
    client, failures = server.node.create_client(SetBool, "switch"), []

    def ask(_message: Int32) -> None:
        with pytest.raises(ServiceError) as caught:
            client.call(_request(), timeout=0.1)
        failures.append(caught.value)

    server.node.create_subscription(Int32, "ask", ask)
    bus.publish("/ask", encode(Int32()))
    lcmtools.spin_once(server.node)
    assert len(failures) == 1


def test_many_clients_at_once_each_get_their_own_answer(begin: Begin, serve: Serve) -> None:
    begin()
    server = _Server()
    serve(server.node)
    answers: list[tuple[bool, bool]] = []

    def call(client: Client[SetBool.Request, SetBool.Response], *, data: bool) -> None:
        for _ in range(10):
            answers.append((data, client.call(_request(data=data), timeout=10.0).success))

    shared = Node("shared").create_client(SetBool, "switch")
    clients = [shared, shared, *(Node(f"c{n}").create_client(SetBool, "switch") for n in range(4))]
    threads = [
        threading.Thread(target=call, args=[client], kwargs={"data": bool(number % 2)})
        for number, client in enumerate(clients)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20)
    assert len(answers) == 60
    assert all(asked == answered for asked, answered in answers)
    assert len(server.calls) == 60


def test_a_call_ends_when_the_program_should(begin: Begin) -> None:
    context = begin()
    client = Node("client").create_client(Trigger, "/nobody")
    threading.Timer(0.05, context.stop).start()
    before = time.monotonic()
    with pytest.raises(ServiceError):
        client.call(Trigger.Request(), timeout=30.0)
    assert time.monotonic() - before < 1.0


def _reply(client: str, sequence: int) -> bytes:
    reply = ServiceReply()
    reply.client, reply.sequence = client, sequence
    reply.payload = encode(Trigger.Response())
    return encode(reply)


def test_replies_that_are_for_nobody_are_passed_over(begin: Begin, bus: FakeBus) -> None:
    begin()
    client = Node("client").create_client(Trigger, "/nobody")
    for payload in (
        b"",
        b"nonsense",
        _reply("stranger", 1),
        _reply(client._id, 99),
        _reply(client._id, 1)[:-1],
    ):
        bus.publish(reply_channel("/nobody"), payload)
    with pytest.raises(ServiceError):
        client.call(Trigger.Request(), timeout=0.05)
    bus.publish(reply_channel("/nobody"), _reply(client._id, 1))  # too late
    assert client._replies == {}


def test_a_reply_with_a_broken_response_is_an_error(begin: Begin, bus: FakeBus) -> None:
    begin()
    client = Node("client").create_client(Trigger, "odd")

    def answer(payload: bytes, _time: int) -> None:
        request = decode(ServiceRequest, payload)
        reply = ServiceReply()
        reply.client, reply.sequence, reply.payload = request.client, request.sequence, b"odd"
        bus.publish(reply_channel("/odd"), encode(reply))

    bus.subscribe(request_channel("/odd"), answer)
    with pytest.raises(LcmtoolsError, match="expected std_srvs/Trigger_Response"):
        client.call(Trigger.Request())


class _Refusing(FakeBus):
    """A bus that takes no replies."""

    def publish(self, channel: str, payload: bytes) -> None:
        if channel == reply_channel("/switch"):
            raise BusError("the network is down")
        super().publish(channel, payload)


def test_a_reply_that_cannot_leave_is_logged_and_the_node_goes_on(
    begin: Begin, serve: Serve, logged: Callable[[str], bool], wait_until: Callable[..., None]
) -> None:
    begin(bus=_Refusing())
    server = _Server()
    serve(server.node)
    client = Node("client").create_client(SetBool, "switch")
    for _ in range(2):
        with pytest.raises(ServiceError, match="did not answer"):
            client.call(_request(), timeout=0.05)
    wait_until(lambda: logged("service /switch raised BusError: the network is down"))
    assert len(server.calls) == 2


def test_requests_that_are_none_are_passed_over(begin: Begin, bus: FakeBus) -> None:
    begin()
    server = _Server()
    for payload in (b"", b"nonsense", encode(Int32()), encode(ServiceRequest())[:-1]):
        bus.publish(request_channel("/switch"), payload)
    lcmtools.spin_once(server.node)
    assert server.calls == []


def test_a_flood_of_requests_is_bounded(begin: Begin, bus: FakeBus) -> None:
    begin()
    server = _Server()
    for sequence in range(2000):
        request = ServiceRequest()
        request.client, request.sequence = "flood", sequence
        request.payload = encode(_request())
        bus.publish(request_channel("/switch"), encode(request))
    lcmtools.spin_once(server.node)
    assert 0 < len(server.calls) <= 100


def test_services_and_clients_are_announced_with_their_type(begin: Begin) -> None:
    begin("__ns:=/husky0")
    node = Node("a")
    node.create_service(SetBool, "switch", lambda _, response: response)
    node.create_client(Trigger, "~go")
    endpoints = {e.role: e for e in node.describe().endpoints}
    assert endpoints[Role.SERVICE].topic == "/husky0/switch"
    assert endpoints[Role.SERVICE].types == ("std_srvs/SetBool",)
    assert endpoints[Role.CLIENT].topic == "/husky0/a/go"
    assert endpoints[Role.CLIENT].types == ("std_srvs/Trigger",)


def test_a_service_name_leaves_room_for_its_channels(begin: Begin) -> None:
    begin()
    node = Node("a")
    longest = "s" * (63 - len("/") - len("/_request"))
    node.create_service(Trigger, longest, lambda _, response: response)
    node.create_client(Trigger, longest)
    with pytest.raises(InvalidName, match="64 bytes"):
        node.create_service(Trigger, longest + "s", lambda _, response: response)
    with pytest.raises(InvalidName, match="64 bytes"):
        node.create_client(Trigger, longest + "s")
