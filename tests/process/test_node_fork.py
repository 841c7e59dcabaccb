"""A process that forks: its bus, its nodes and their goodbye stay its own."""

import os
import signal
from pathlib import Path

import pytest

_SCRIPT = """
import os, signal, sys, time
import lcmtools
lcmtools.init([])
node = lcmtools.Node("parent")
heard, told = os.pipe()
child = os.fork()
if not child:
    assert not lcmtools.ok()
    os.write(told, b"!")
    {child}
os.read(heard, 1)
{parent}
print("ended with", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
lcmtools.spin(node)
"""
_ENDINGS = {
    "ends as programs do": ("sys.exit(0)", "", 0),
    "is terminated": ("time.sleep(60)", "os.kill(child, signal.SIGTERM)", -signal.SIGTERM),
    "has a node of its own": (
        "lcmtools.init([]); lcmtools.Node('child'); lcmtools.shutdown(); sys.exit(5)",
        "",
        5,
    ),
}


def _records():
    folder = Path(os.environ["XDG_RUNTIME_DIR"]) / "lcmtools" / "records"
    return [path for path in folder.rglob("*") if path.is_file()]


@pytest.mark.parametrize("ending", _ENDINGS)
def test_a_forked_process_leaves_the_nodes_to_its_parent(start_python, bus_url, ending):
    child, parent, code = _ENDINGS[ending]
    source = _SCRIPT.format(child=child, parent=parent)
    program = start_python(source, LCM_DEFAULT_URL=bus_url)
    program.wait_for(f"ended with {code}")
    assert len(_records()) == 1
    program.send_signal(signal.SIGTERM)
    assert program.wait() == 0
    assert not _records()


_USES = """
import os
import lcmtools
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger

lcmtools.init([])
node = lcmtools.Node("parent")
publisher = node.create_publisher(String, "chatter", 10)
payloads = node.create_payload_publisher("payloads")
client = node.create_client(Trigger, "service")
rate = node.create_rate(10)
heard = []
node.create_subscription(String, "chatter", lambda message: heard.append(message.data), 10)
child = os.fork()
message = String()
if not child:
    message.data = "child"
    for use in (
        lambda: publisher.publish(message),
        lambda: payloads.publish_payload(b"12345678"),
        lambda: client.call(Trigger.Request(), timeout=0.1),
        lambda: node.get_logger().info("hi"),
        lambda: rate.sleep(),
        lambda: node.create_timer(1.0, print),
        lambda: publisher.subscriber_count(),
        lambda: node.graph(),
        lambda: lcmtools.spin_once(node, 1.0),
        lambda: lcmtools.spin(node),
        lambda: node.create_subscription(String, "chatter", print, 10),
    ):
        try:
            use()
        except lcmtools.errors.BusOfParent as error:
            print(error, flush=True)
    node.destroy_node()
    os._exit(0)
os.waitpid(child, 0)
message.data = "parent"
while "parent" not in heard:
    publisher.publish(message)
    lcmtools.spin_once(node, 0.1)
print("heard", sorted(set(heard)))
"""


@pytest.mark.parametrize(
    "url", ["udpm://239.255.76.67:{}?ttl=0", "memq://", "zenoh://224.0.0.224:{}"]
)
def test_a_forked_process_is_told_that_the_nodes_are_its_parents(start_python, free_port, url):
    program = start_python(_USES, LCM_DEFAULT_URL=url.format(free_port()))
    program.wait_for("heard ['parent']")
    assert program.wait() == 0
    told = [line for line in program.lines if "the bus belongs to the parent process" in line]
    assert len(told) == 11
    assert not any("[ERROR]" in line for line in program.lines)


# a thread is in the middle of a computation and of its lock when the process forks
_BUSY = """
import os, signal, threading
from lcmtools.forks import cached_property, free_in_child

class Type:
    def __init__(self, is_slow):
        self.is_slow = is_slow

    @cached_property
    def coder(self):
        if self.is_slow:
            computing.set()
            forked.wait()
        return 7

def hold():
    with lock:
        held.set()
        computing.wait()

computing, forked, held, lock = (*(threading.Event() for _ in range(3)), threading.RLock())
free_in_child(lock)
holder, slow = threading.Thread(target=hold), threading.Thread(target=lambda: Type(True).coder)
holder.start()
held.wait()
slow.start()
child = os.fork()
if not child:
    signal.alarm(20)
    with lock:
        os._exit(Type(False).coder)
forked.set()
slow.join()
print("the child ended with", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


def test_a_child_does_not_wait_for_a_thread_of_its_parent(start_python):
    start_python(_BUSY).wait_for("the child ended with 7")
