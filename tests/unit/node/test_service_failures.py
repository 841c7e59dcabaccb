"""Services that fail, and those that hear what was not meant for them."""

import pytest
from fixtures.fake_bus import FakeBus
from fixtures.says import raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.errors import BusError, LcmtoolsError, ServiceError, ValueMismatch
from lcmtools.messages.codec import decode, encode
from lcmtools.node.service import reply_channel, request_channel
from lcmtools.types.lcmtools_msgs import ServiceReply, ServiceRequest
from lcmtools.types.std_msgs import Int32
from lcmtools.types.std_srvs import SetBool, Trigger


def _request(*, data=True):
    request = SetBool.Request()
    request.data = data
    return request


def test_a_service_that_raises_fails_the_call_and_its_node_goes_on(
    begin, serve, logged, wait_until, start_switch
):
    begin()
    node = Node("server")

    def fail(_request, _response):
        raise RuntimeError("no power")

    node.create_service(Trigger, "fail", fail)
    server = start_switch()
    serve(node)
    serve(server.node)
    client = Node("client")
    with pytest.raises(ServiceError, match=r"/fail: RuntimeError\('no power'\)"):
        client.create_client(Trigger, "fail").call(Trigger.Request())
    assert client.create_client(SetBool, "switch").call(_request()).success
    wait_until(lambda: logged("service /fail raised RuntimeError: no power\nTraceback"))


def test_an_error_for_the_caller_is_passed_on_without_a_traceback(begin, serve, capsys):
    begin()
    node = Node("server")

    def refuse(_request, _response):
        raise LcmtoolsError("the robot is not enabled", "enable it first")

    node.create_service(Trigger, "go", refuse)
    serve(node)
    client = Node("client").create_client(Trigger, "go")
    with raises_saying(ServiceError, "/go: the robot is not enabled; enable it first"):
        client.call(Trigger.Request())
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("answer", [None, "text", Int32(), Trigger.Request()])
def test_a_service_that_returns_no_response_fails_the_call(begin, serve, answer):
    begin()
    node = Node("server")
    node.create_service(Trigger, "odd", lambda _request, _response: answer)
    serve(node)
    client = Node("client").create_client(Trigger, "odd")
    with pytest.raises(ServiceError, match=r"/odd: .*std_srvs/Trigger_Response"):
        client.call(Trigger.Request(), timeout=5.0)


def test_a_request_of_another_type_fails_the_call(begin, serve, start_switch):
    begin()
    server = start_switch()
    serve(server.node)
    client = Node("client").create_client(Trigger, "switch")
    with pytest.raises(ServiceError, match=r"/switch: .*std_srvs/SetBool_Request"):
        client.call(Trigger.Request())
    with pytest.raises((ServiceError, ValueMismatch)):
        client.call(Int32())
    assert server.calls == []


def test_a_value_that_does_not_fit_is_refused_before_it_is_sent(begin):
    begin()
    client = Node("client").create_client(SetBool, "switch")
    request = SetBool.Request()
    request.data = "maybe"
    with pytest.raises(ValueMismatch, match="data"):
        client.call(request)


def _reply(client, sequence):
    reply = ServiceReply()
    reply.client, reply.sequence = client, sequence
    reply.payload = encode(Trigger.Response())
    return encode(reply)


def test_replies_that_are_for_nobody_are_passed_over(begin, bus):
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


@pytest.mark.parametrize(
    ("status", "said"),
    [
        (ServiceReply.OK, "/odd: expected std_srvs/Trigger_Response"),
        (ServiceReply.FAILED, "/odd: it failed, and does not say why"),
    ],
)
def test_a_reply_with_a_broken_response_is_a_failure_of_the_service(begin, bus, status, said):
    begin()
    client = Node("client").create_client(Trigger, "odd")

    def answer(payload, _time):
        request = decode(ServiceRequest, payload)
        reply = ServiceReply()
        reply.client, reply.sequence, reply.payload = request.client, request.sequence, b"odd"
        reply.status = status
        bus.publish(reply_channel("/odd"), encode(reply))

    bus.subscribe(request_channel("/odd"), answer)
    with pytest.raises(ServiceError, match=said):
        client.call(Trigger.Request())


class _Refusing(FakeBus):
    """A bus that takes no replies."""

    def deliver(self, channel, payload):
        if channel == reply_channel("/switch"):
            raise BusError("the network is down")
        super().deliver(channel, payload)


def test_a_reply_that_cannot_leave_is_logged_and_the_node_goes_on(
    begin, serve, logged, wait_until, start_switch
):
    begin(bus=_Refusing())
    server = start_switch()
    serve(server.node)
    client = Node("client").create_client(SetBool, "switch")
    for _ in range(2):
        with pytest.raises(ServiceError, match="did not answer"):
            client.call(_request(), timeout=0.05)
    wait_until(lambda: logged("service /switch raised BusError: the network is down"))
    assert len(server.calls) == 2


def test_requests_that_are_none_are_passed_over(begin, bus, start_switch):
    begin()
    server = start_switch()
    for payload in (b"", b"nonsense", encode(Int32()), encode(ServiceRequest())[:-1]):
        bus.publish(request_channel("/switch"), payload)
    lcmtools.spin_once(server.node)
    assert server.calls == []


def test_a_flood_of_requests_is_bounded(begin, bus, start_switch):
    begin()
    server = start_switch()
    for sequence in range(2000):
        request = ServiceRequest()
        request.client, request.sequence = "flood", sequence
        request.payload = encode(_request())
        bus.publish(request_channel("/switch"), encode(request))
    lcmtools.spin_once(server.node)
    assert 0 < len(server.calls) <= 100
