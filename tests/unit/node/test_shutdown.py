"""A node's program that is asked over the bus to end."""

import pytest
from fixtures.says import assert_says

import lcmtools
from lcmtools import Node
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    SHUTDOWN_CHANNEL,
    Shutdown,
    decode_announcement,
    encode_shutdown,
)


def _ask(bus, target, requester="a test"):
    bus.publish(SHUTDOWN_CHANNEL, encode_shutdown(Shutdown(target, 9, requester)))


def _answers(bus):
    payloads = [payload for channel, payload in tuple(bus.published) if channel == NODE_CHANNEL]
    said = [announced for payload in payloads if (announced := decode_announcement(payload))]
    return [one.node.name for one in said if one.answers == 9]


def test_it_answers_logs_who_asks_and_ends(begin, bus, capsys):
    context = begin()
    Node("other")
    node = Node("driver")
    _ask(bus, node.describe().id)
    assert _answers(bus) == ["/driver"]
    assert not context.ok()
    lcmtools.spin(node)
    assert_says(capsys.readouterr().err, "[/driver]: ", "shutdown", "by a test\n")


def test_asked_again_it_answers_again_and_logs_once(begin, bus, capsys):
    begin()
    node = Node("driver")
    for _ in range(3):
        _ask(bus, node.describe().id, "")
    assert _answers(bus) == ["/driver"] * 3
    assert capsys.readouterr().err.count("shutdown requested over the bus") == 1


@pytest.mark.parametrize("target", ["", "/driver", "driver", "no-such-id"])
def test_only_its_id_means_a_node(begin, bus, target):
    context = begin()
    Node("driver")
    _ask(bus, target)
    assert context.ok()


@pytest.mark.parametrize("payload", [b"", b"nonsense", encode_shutdown(Shutdown("x"))[:-1]])
def test_what_is_no_request_is_passed_over(begin, bus, payload):
    context = begin()
    Node("driver")
    bus.publish(SHUTDOWN_CHANNEL, payload)
    assert context.ok()


@pytest.mark.parametrize(
    "error", [BrokenPipeError(), ValueError("closed file"), OSError(28, "full")]
)
def test_it_ends_although_its_log_fails(begin, bus, monkeypatch, error):
    context = begin()
    node = Node("driver")

    def fail(*_):
        raise error

    monkeypatch.setattr(node.get_logger(), "warning", fail)
    _ask(bus, node.describe().id)
    assert not context.ok()


def test_it_ends_although_it_cannot_answer(begin, bus, monkeypatch):
    context = begin()
    node = Node("driver")

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(context.announcer, "answer", fail)
    with pytest.raises(OSError, match="No space"):  # which a real bus reports
        _ask(bus, node.describe().id)
    assert not context.ok()


def test_it_ends_before_it_logs(begin, bus):
    context = begin()
    node = Node("driver")
    logged = []
    node.get_logger().warning = lambda *_: logged.append(context.ok())
    _ask(bus, node.describe().id)
    assert logged == [False]
