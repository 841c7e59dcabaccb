"""Nodes whose callbacks run on a thread of their own, as in a notebook."""

import threading
import time

import pytest
from fixtures.says import raises_saying

import lcmtools
from lcmtools import Node
from lcmtools.errors import UsageError
from lcmtools.types.std_srvs import Trigger


@pytest.fixture
def node(begin):
    begin()
    return Node("notebook")


def test_callbacks_run_beside_the_program_until_stop(node, wait_until):
    threads = []
    node.create_timer(0.001, lambda: threads.append(threading.get_ident()))
    with lcmtools.spin_in_background(node) as spin:
        wait_until(lambda: len(threads) > 2)
        assert spin.is_running()
    assert not spin.is_running()
    assert len(set(threads)) == 1
    assert threads[0] != threading.get_ident()
    seen = len(threads)
    lcmtools.spin_once(node, 0.05)
    assert len(threads) > seen, "the node spins again"
    spin.stop()


def test_a_cell_that_is_executed_again_starts_nothing_twice(node):
    first = lcmtools.spin_in_background(node)
    assert lcmtools.spin_in_background(node) is first
    first.stop()
    second = lcmtools.spin_in_background(node)
    assert second is not first
    assert second.is_running()


def test_shutdown_ends_it_and_a_new_node_begins_anew():
    for _ in range(3):  # a notebook's cell, executed again
        lcmtools.shutdown()
        lcmtools.init([], url="memq://", handle_signals=False)
        spin = lcmtools.spin_in_background(Node("notebook"))
        assert spin.is_running()
    lcmtools.shutdown()
    assert not spin.is_running()


def test_a_callback_may_stop_it_or_shut_down(node, wait_until):
    spins = []
    stopping = node.create_timer(0.001, lambda: [spin.stop() for spin in spins])
    spins.append(lcmtools.spin_in_background(node))
    wait_until(lambda: not spins[0].is_running())
    node.destroy_timer(stopping)
    node.create_timer(0.001, lcmtools.shutdown)
    spins[:] = [lcmtools.spin_in_background(node)]
    wait_until(lambda: not spins[0].is_running())
    assert node.is_destroyed


def test_an_exception_is_logged_and_it_goes_on(node, wait_until, capsys):
    calls = []

    def fail():
        calls.append(time.monotonic())
        raise ValueError("no such wheel")

    node.create_timer(0.001, fail)
    with lcmtools.spin_in_background(node):
        wait_until(lambda: len(calls) > 2)
    assert "ValueError: no such wheel" in capsys.readouterr().err


def test_a_program_calls_a_service_of_its_own_node_in_the_background(node):
    def answer(_, response):
        response.message = "done"
        return response

    node.create_service(Trigger, "work", answer)
    client = node.create_client(Trigger, "work")
    with lcmtools.spin_in_background(node):
        assert client.call(Trigger.Request(), timeout=5.0).message == "done"


def test_a_new_timer_wakes_the_waiting_thread(node, monkeypatch):
    woken = []
    monkeypatch.setattr(node.context, "wake", lambda: woken.append(True))
    node.create_timer(1.0, print)
    assert woken == [True]


def test_it_ends_with_its_nodes(node, wait_until):
    other = Node("other")
    spin = lcmtools.spin_in_background(node, other)
    node.destroy_node()
    assert spin.is_running()
    other.destroy_node()
    wait_until(lambda: not spin.is_running())


def test_what_cannot_spin_is_refused(node):
    with raises_saying(UsageError, "no node to run", "lcmtools.spin_in_background(node)"):
        lcmtools.spin_in_background()
    with raises_saying(UsageError, "lcmtools.spin_in_background needs a node"):
        lcmtools.spin_in_background("node")
    with lcmtools.spin_in_background(node):
        with raises_saying(UsageError, "lcmtools.spin(/notebook) runs already"):
            lcmtools.spin(node)
        with raises_saying(UsageError, "lcmtools.spin_in_background(/notebook) runs already"):
            lcmtools.spin_in_background(node, Node("other"))
    node.destroy_node()
    with raises_saying(UsageError, "/notebook was destroyed"):
        lcmtools.spin_in_background(node)
