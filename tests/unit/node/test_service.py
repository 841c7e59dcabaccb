"""Services: each request is answered once, whatever gets lost on the way."""

import threading
import time

import pytest
from fixtures.fake_bus import FakeBus
from fixtures.says import assert_says

import lcmtools
from lcmtools import Node
from lcmtools.errors import InvalidName, ServiceError, ServiceTimeout, UsageError
from lcmtools.graph.model import Role
from lcmtools.messages.codec import encode
from lcmtools.node.replies import Replies
from lcmtools.node.service import reply_channel, request_channel
from lcmtools.types.lcmtools_msgs import ServiceRequest
from lcmtools.types.std_msgs import Int32
from lcmtools.types.std_srvs import SetBool, Trigger


class _Lossy(FakeBus):
    """A bus that loses the first messages of a channel."""

    def __init__(self, channel, count=1):
        super().__init__()
        self.left = count
        self._channel = channel

    def deliver(self, channel, payload):
        if channel == self._channel and self.left > 0:
            self.left -= 1
            return
        super().deliver(channel, payload)


def _request(*, data=True):
    request = SetBool.Request()
    request.data = data
    return request


def test_a_request_is_answered(begin, serve, start_switch):
    begin()
    server = start_switch()
    serve(server.node)
    client = Node("client").create_client(SetBool, "switch")
    for data in (True, False):
        response = client.call(_request(data=data))
        assert isinstance(response, SetBool.Response)
        assert response.success is data
    assert server.calls == [True, False]
    assert response.message == "call 2"


def test_a_lost_request_is_sent_again_and_answered_once(begin, serve, start_switch, stopwatch):
    begin(bus=_Lossy(request_channel("/switch")))
    server = start_switch()
    serve(server.node)
    watch = stopwatch()
    response = Node("client").create_client(SetBool, "switch").call(_request(), timeout=20.0)
    assert watch.seconds() < 2.0
    assert response.message == "call 1"
    assert server.calls == [True]


def test_a_lost_reply_is_sent_again_without_a_second_call(begin, serve, start_switch):
    begin(bus=_Lossy(reply_channel("/switch"), 2))
    server = start_switch()
    serve(server.node)
    response = Node("client").create_client(SetBool, "switch").call(_request(), timeout=20.0)
    assert response.message == "call 1"
    assert server.calls == [True]


def test_a_slow_service_is_called_once(begin, serve):
    begin()
    node, calls = Node("server"), []

    def slow(_request, response):
        calls.append(1)
        time.sleep(0.6)  # over two retries
        return response

    node.create_service(Trigger, "slow", slow)
    serve(node)
    client = Node("client").create_client(Trigger, "slow")
    client.call(Trigger.Request(), timeout=20.0)
    assert calls == [1]
    client.call(Trigger.Request(), timeout=20.0)
    assert calls == [1, 1]


@pytest.mark.timing
def test_no_answer_is_an_error_in_time(begin, stopwatch):
    begin()
    client = Node("client").create_client(Trigger, "/nobody")
    watch = stopwatch()
    with pytest.raises(ServiceError, match=r"/nobody .* 0\.1 s") as caught:
        client.call(Trigger.Request(), timeout=0.1)
    assert watch.seconds() < 0.5
    assert "lcmtools node list" in caught.value.hint


def test_a_client_may_call_inside_a_callback(begin, bus, serve, start_switch):
    begin()
    server = start_switch()
    serve(server.node)
    node, answers = Node("caller"), []
    client = node.create_client(SetBool, "switch")
    node.create_subscription(
        Int32, "ask", lambda _: answers.append(client.call(_request()).message)
    )
    bus.publish("/ask", encode(Int32()))
    lcmtools.spin_once(node)
    assert answers == ["call 1"]


def test_many_clients_at_once_each_get_their_own_answer(begin, serve, start_switch):
    begin()
    server = start_switch()
    serve(server.node)
    answers = []

    def call(client, *, data):
        for _ in range(10):
            response = client.call(_request(data=data), timeout=10.0)
            answers.append(response.success is data)

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
    assert answers == [True] * 60
    assert len(server.calls) == 60


def test_a_call_ends_when_the_program_should(begin, stopwatch):
    context = begin()
    client = Node("client").create_client(Trigger, "/nobody")
    threading.Timer(0.05, context.stop).start()
    watch = stopwatch()
    with pytest.raises(ServiceError):
        client.call(Trigger.Request(), timeout=30.0)
    assert watch.seconds() < 1.0


def test_services_and_clients_are_announced_with_their_type(begin):
    begin("__ns:=/husky0")
    node = Node("a")
    node.create_service(SetBool, "switch", lambda _, response: response)
    node.create_client(Trigger, "~go")
    endpoints = {e.role: e for e in node.describe().endpoints}
    assert endpoints[Role.SERVICE].topic == "/husky0/switch"
    assert endpoints[Role.SERVICE].types == ("std_srvs/SetBool",)
    assert endpoints[Role.CLIENT].topic == "/husky0/a/go"
    assert endpoints[Role.CLIENT].types == ("std_srvs/Trigger",)


def test_a_service_name_leaves_room_for_its_channels(begin):
    begin()
    node = Node("a")
    longest = "s" * (63 - len("/") - len("/_request"))
    node.create_service(Trigger, longest, lambda _, response: response)
    node.create_client(Trigger, longest)
    with pytest.raises(InvalidName, match="64 bytes"):
        node.create_service(Trigger, longest + "s", lambda _, response: response)
    with pytest.raises(InvalidName, match="64 bytes"):
        node.create_client(Trigger, longest + "s")


def test_a_request_that_is_repeated_while_it_is_answered_gets_one_reply(begin, bus):
    begin()
    node = Node("server")
    request = ServiceRequest()
    request.client, request.sequence = "c", 1
    request.payload = encode(Trigger.Request())

    def answer(_request, response):
        bus.publish(request_channel("/slow"), encode(request))  # as a client does that waits
        return response

    node.create_service(Trigger, "slow", answer)
    bus.publish(request_channel("/slow"), encode(request))
    bus.publish(request_channel("/slow"), encode(request))
    node.callbacks.run_ready()
    replies = [channel for channel, _ in bus.published if channel == reply_channel("/slow")]
    assert len(replies) == 1
    assert [e.messages for e in node.describe().endpoints if e.topic == "/slow"] == [1]


def test_a_repeated_request_is_not_called_again_after_thousands_of_others(begin, bus):
    begin()
    node, calls = Node("server"), []

    def answer(_request, response):
        calls.append(1)
        return response

    node.create_service(Trigger, "go", answer)
    for sequence in (*range(2000), 0):
        request = ServiceRequest()
        request.client, request.sequence = "c", sequence
        request.payload = encode(Trigger.Request())
        bus.publish(request_channel("/go"), encode(request))
        node.callbacks.run_ready()
    assert len(calls) == 2000


def test_a_large_reply_is_not_sent_again_while_it_travels():
    replies, key = Replies(), ("c", 1)
    replies.add(key, bytes(20_000_000))
    assert replies.to_send(key, 10.0) is not None
    assert replies.to_send(key, 10.5) is None
    assert replies.to_send(key, 11.5) is not None


def test_large_replies_are_forgotten_and_their_requests_are_not():
    replies, keys = Replies(), [("c", number) for number in range(4)]
    for key in keys:
        replies.add(key, bytes(30 << 20))
    assert all(key in replies for key in keys)
    assert [replies.to_send(key, 1.0) is not None for key in keys] == [False, False, True, True]


def test_a_response_that_lcm_cannot_carry_fails_the_call(begin, serve, monkeypatch):
    monkeypatch.setattr("lcmtools.node.service.MESSAGE_MAX", 2000)
    begin()
    node = Node("server")

    def answer(_request, response):
        response.message = "x" * 2000
        return response

    node.create_service(Trigger, "much", answer)
    serve(node)
    client = Node("client").create_client(Trigger, "much")
    with pytest.raises(ServiceError, match=r"/much: .*20\d\d bytes"):
        client.call(Trigger.Request())


def test_an_asynchronous_call_ends_while_its_node_spins(begin, serve, start_switch):
    begin(bus=_Lossy(request_channel("/switch")))  # the first request is lost
    server = start_switch()
    serve(server.node)
    node = Node("client")
    future = node.create_client(SetBool, "switch").call_async(_request())
    seen = []
    future.add_done_callback(lambda one: seen.append((one.result(), threading.get_ident())))
    assert future.result() is None
    lcmtools.spin_until_future_complete(node, future, 20.0)
    response = future.result()
    assert response is not None
    assert response.message == "call 1"
    assert seen == [(response, threading.get_ident())]
    assert server.calls == [True]


def test_an_asynchronous_call_raises_the_failure_of_its_service(begin, serve):
    begin()
    server, node = Node("server"), Node("client")

    def refuse(_request, _response):
        raise ServiceError("it is locked")

    server.create_service(SetBool, "switch", refuse)
    serve(server)
    future = node.create_client(SetBool, "switch").call_async(_request())
    lcmtools.spin_until_future_complete(node, future, 20.0)
    assert future.done()
    assert "it is locked" in str(future.exception())
    with pytest.raises(ServiceError, match="/switch: it is locked"):
        future.result()


def test_a_call_of_ones_own_service_ends_while_both_spin(begin, start_switch):
    begin()
    node = start_switch().node
    future = node.create_client(SetBool, "switch").call_async(_request())
    lcmtools.spin_until_future_complete(node, future, 20.0)
    assert future.done()


def test_a_call_without_an_answer_is_not_done(begin, bus):
    begin(bus=bus)
    node = Node("client")
    sent = []
    bus.subscribe(request_channel("/nobody"), lambda payload, _: sent.append(payload))
    future = node.create_client(SetBool, "nobody").call_async(_request())
    while len(sent) < 2:  # it is repeated
        lcmtools.spin_until_future_complete(node, future, 0.05)
    assert not future.done()
    future.cancel()
    assert (future.done(), future.cancelled(), future.result()) == (True, True, None)
    before = len(sent)
    lcmtools.spin_once(node, 0.6)
    assert len(sent) == before


def test_a_service_of_this_program_that_nobody_spins_is_named(begin):
    begin()
    server, node = Node("server"), Node("client")
    server.create_service(Trigger, "go", lambda _, response: response)
    with pytest.raises(ServiceTimeout) as raised:
        node.create_client(Trigger, "go").call(Trigger.Request(), timeout=0.05)
    assert str(raised.value) == (
        "/go did not answer within 0.05 s: its node /server is in this program, and no other "
        "thread spins it; use call_async, or call spin_in_background before"
    )


@pytest.mark.parametrize("owner", ["client", "server"])
def test_a_callback_that_calls_a_service_of_its_own_thread_is_told_at_once(owner, begin):
    begin()
    nodes = {name: Node(name) for name in ("client", "server")}
    nodes[owner].create_service(Trigger, "go", lambda _, response: response)
    client = nodes["client"].create_client(Trigger, "go")
    errors = []

    def call():
        with pytest.raises(ServiceError) as raised:
            client.call(Trigger.Request(), timeout=1e6)
        errors.append(str(raised.value))
        lcmtools.shutdown()

    nodes["client"].create_timer(0.01, call)
    lcmtools.spin(*nodes.values())
    assert_says(errors[0], "/go cannot answer", f"/{owner}", "this thread", "call_async")


def test_what_is_no_future_is_named(begin):
    begin()
    with pytest.raises(UsageError, match=r"needs a future, got None; .*call_async"):
        lcmtools.spin_until_future_complete(Node("n"), None)
