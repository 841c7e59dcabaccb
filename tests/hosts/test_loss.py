"""Who loses messages, and where: on the network, in a kernel's buffer, or in a node's queue."""

import json
import re
import signal

_SLOW = """
import time, lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("slow")
node.create_subscription(String, "/fast", lambda _: time.sleep(0.2), 5)
print("listens", flush=True)
lcmtools.spin(node)
"""
_FAST = """
import time, lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
publisher = lcmtools.Node("fast").create_publisher(String, "/fast")
while True:
    publisher.publish(String())
    print("sends", flush=True)
    time.sleep(0.01)
"""
_WHERE = ("loss", "kernel-drops", "stuck-listeners", "queue-drops", "reassembly", "small-buffer")


def _losses(host):
    """The findings of wtf on loss there: the rules with their items."""
    found = json.loads(host.lcmtools("wtf", "--json", "--wait", "0.7s").stdout)
    return {one["rule"]: one["items"] for one in found if one["rule"] in _WHERE}


def _is_a_tenth(lost, of):
    """Return whether one in ten messages was lost, which depends on where counting began."""
    return lost > 0 and of // 10 - 1 <= lost <= of // 10 + 1


def test_loss_on_the_network_is_told_of_each_sender_where_it_shows(network, plain):
    net = network("ada", "bob")
    ada, bob = net.hosts
    ada.python(plain, "PLAIN", "8", "0.005").wait_for("sends")
    ada.python(_FAST).wait_for("sends")
    net.lose(10)
    found = _losses(bob)
    assert list(found) == ["loss"]
    for sender in ("/fast (10.76.0.1:", "10.76.0.1:"):
        (item,) = [one for one in found["loss"] if one.startswith(sender)]
        assert item.endswith("on the network")
        lost, of = map(int, re.findall(r": (\d+) of (\d+) \(", item)[0])
        assert _is_a_tenth(lost, of)
    assert _losses(ada) == {}

    (plain_topic, fast) = json.loads(bob.out("info", "PLAIN", "/fast", "--json"))
    for publisher in (*plain_topic["other_publishers"], *fast["publishers"]):
        assert _is_a_tenth(publisher["lost"], publisher["lost_of"])
    rows = bob.out("info", "PLAIN").splitlines()
    assert any(row.startswith("     did not arrive here: ") for row in rows)
    assert "did not arrive" not in ada.out("info", "PLAIN")
    told = bob.lcmtools("hz", "PLAIN", "-n", "1")
    assert "lcmtools hz: of 10.76.0.1:" in told.stderr

    net.mend()
    assert _losses(bob) == {}


def test_nodes_are_found_although_messages_get_lost(network, lcmtools_path, wait_until):
    """A question to the nodes, or an answer, may be lost: here each second one."""
    net = network("ada", "bob")
    ada, bob = net.hosts
    ada.start(lcmtools_path, "run", "listener")
    wait_until(lambda: bob.out("node", "list") == "/listener\n")
    for loser in (bob, ada):
        net.lose(2, of=loser)
        for _ in range(2):
            assert bob.out("node", "list") == "/listener\n"
        net.mend()


def test_a_full_buffer_of_the_kernel_is_not_the_network(pair, plain, lcm_program, wait_until):
    ada, bob = pair
    sink = bob.start(lcm_program("lcm-sink"))
    ada.python(plain, "FLOW", "20000", "0.005").wait_for("sends")
    wait_until(lambda: "sink" in bob.out("node", "list", "-a", "--wait", "0.1s"))
    sink.send_signal(signal.SIGSTOP)
    found = _losses(bob)
    assert list(found) == ["stuck-listeners"]
    assert "lcm-sink" in found["stuck-listeners"][0]
    assert _losses(ada) == {}
    sink.send_signal(signal.SIGCONT)
    wait_until(lambda: _losses(bob) == {})  # on a busy computer 50 ms of room may still be too few


def test_a_full_queue_of_a_node_is_neither_network_nor_kernel(pair, wait_until):
    ada, bob = pair
    slow = bob.python(_SLOW)
    slow.wait_for("listens")
    ada.python(_FAST).wait_for("sends")
    wait_until(lambda: "drops: 0, depth: 5" not in bob.out("info", "/fast"))
    for host in pair:
        found = _losses(host)
        assert list(found) == ["queue-drops"]
        assert found["queue-drops"][0].startswith("/slow lost ")
    text = bob.out("info", "/fast")
    assert "did not arrive" not in text
    assert "depth: 5" in text
