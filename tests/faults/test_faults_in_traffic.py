"""Faults in what is sent: by two, not at all, too slowly, unevenly, under bad names."""

import signal
from typing import Any

import pytest

RATES = """
import signal, sys
import lcmtools
from lcmtools.types.std_msgs import Int32
class Beat(lcmtools.Node):
    def __init__(self):
        super().__init__("beat")
        self.out, self.number, self.every = self.create_publisher(Int32, "/beat"), 0, 1
        self.create_timer(0.01, self.beat)
    def beat(self):
        self.number += 1
        if self.number % self.every == 0:
            self.out.publish(Int32())
lcmtools.init()
node = Beat()
signal.signal(signal.SIGUSR1, lambda *_: setattr(node, "every", int(sys.argv[1])))
signal.signal(signal.SIGUSR2, lambda *_: setattr(node, "every", 1))
lcmtools.spin(node)
"""
SKIPS = """
import socket, sys, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
number = 0
while True:
    number += 1
    if number % int(sys.argv[1]):
        data = b"LC02" + number.to_bytes(4, "big") + b"SKIP\\0"
        sender.sendto(data, ("239.255.76.67", 7667))
    if number == 3:
        print("sends", flush=True)
    time.sleep(0.01)
"""


def test_two_plain_programs_steer_the_same_actuator(world: Any) -> None:
    world.hears("/cmd_vel")
    first, second = (world.sends("bus.publish('/cmd_vel', Twist().encode())") for _ in "ab")
    world.finds("competing-publishers", first.pid, second.pid, "/cmd_vel", "end one of them")
    world.end(first)
    world.is_silent()


def test_two_nodes_steer_the_same_simulator(world: Any) -> None:
    world.node("sim", "--world", "dolly")
    world.node("moving_robot")
    world.node("moving_robot", "__name:=second")
    found = world.finds("competing-publishers", "/moving_robot", "/second", wait="1.2s")
    assert "start it with /dolly/cmd_vel:=/dolly/cmd_vel_2" in found.remedies[0]
    world.end(world.of_node("/second"))
    world.is_silent()


def test_a_node_and_a_c_program_steer_alternatives_of_one_input(world: Any) -> None:
    world.node("sim", "--world", "husky")
    pub = ("pub", "-r", "10", "/husky0/velocity_cmd", "geometry_msgs/Twist", "{}")
    world.tool(*pub, "__name:=fast")
    other = world.sends("bus.publish('/husky0/wheel_cmd', JointState().encode())", 0.1)
    world.finds(
        "competing-publishers", "/fast", other.pid, "/husky0/velocity_cmd and /husky0/wheel_cmd"
    )
    world.end(other)
    world.is_silent()


def test_a_sender_whose_messages_get_lost(world: Any) -> None:
    sender = world.script(SKIPS, "10", ready="sends")
    world.finds("loss", sender.pid, "before they left it")
    world.end(sender)
    world.script(SKIPS, "1000000", ready="sends")
    world.is_silent()


def _beating(world: Any, every: int) -> Any:
    """A node that has beaten long enough to have a usual rate, and a command that listens."""
    beat = world.script(RATES, str(every))
    world.until(lambda: beat.pid in world.pids())
    world.tool("hz", "/beat")
    world.until(lambda: _beats(world) > 150)
    return beat


def _beats(world: Any) -> int:
    ends = [end for node in world.graph().nodes for end in node.endpoints]
    return max((end.messages for end in ends if end.topic == "/beat"), default=0)


def test_a_node_that_has_become_slower(world: Any) -> None:
    beat = _beating(world, 10)
    beat.send_signal(signal.SIGUSR1)
    world.finds("slow-rate", "/beat", " Hz in place of ", wait="0.6s")
    beat.send_signal(signal.SIGUSR2)
    world.is_silent()


def test_a_node_that_has_fallen_silent(world: Any) -> None:
    beat = _beating(world, 10**9)
    beat.send_signal(signal.SIGUSR1)
    world.until(lambda: _silence(world) > 3.2)
    world.finds("silent", "/beat", " s ago, ", wait="1.2s")
    beat.send_signal(signal.SIGUSR2)
    world.is_silent()


def _silence(world: Any) -> float:
    graph = world.graph()
    ends = [end for node in graph.nodes for end in node.endpoints if end.topic == "/beat"]
    last = max(end.last_time for end in ends)
    return (graph.time - last) / 1e9


def test_a_plain_publisher_that_is_frozen(world: Any) -> None:
    """Nothing of it is on the bus any more: its process tells."""
    world.node("talker")
    world.node("listener")
    sender = world.c("sends", "POSE", "00", "100", "50")
    sender.send_signal(signal.SIGSTOP)
    world.obey(world.finds("silent", f"(pid {sender.pid})", f"kill -CONT {sender.pid}"))
    world.is_silent()


@pytest.mark.parametrize("channel", ["/map[0]", "/tab\t"])
def test_a_name_that_nobody_can_subscribe_to(world: Any, channel: str) -> None:
    world.sends("bus.publish('/pose', Twist().encode())")
    sender = world.sends(f"bus.publish({channel!r}, Twist().encode())")
    world.finds("names", repr(channel), sender.pid)
    world.end(sender)
    world.is_silent()


def test_a_name_that_is_nearly_too_long(world: Any) -> None:
    sender = world.sends(f"bus.publish('/{'a' * 60}', Twist().encode())")
    world.finds("names", "a" * 60, sender.pid)
    world.end(sender)
    world.sends(f"bus.publish('/{'a' * 50}', Twist().encode())")
    world.is_silent()


def test_two_names_that_look_the_same(world: Any) -> None:
    world.hears(".*")
    world.sends("bus.publish('/pose', Twist().encode())")
    sender = world.sends("bus.publish('/Pose', Twist().encode())")
    world.finds("names", "/Pose", "/pose", sender.pid)
    world.end(sender)
    world.is_silent()


def test_messages_that_come_in_bursts(world: Any) -> None:
    burst = "[(bus.publish('/a', Twist().encode()), time.sleep(0.002)) for _ in range(15)]"
    sender = world.sends(burst, 0.6)
    world.finds("irregular", sender.pid, "/a", wait="1.5s")
    world.end(sender)
    world.sends("bus.publish('/a', Twist().encode())", 0.04)
    world.is_silent()


def test_a_simulator_that_was_made_slow(world: Any) -> None:
    world.node("sim", "--world", "empty")
    world.type("lcmtools sim set-rate 0.4")
    found = world.finds("slow-simulator", "/gazebo", "0.4", wait="0.8s")
    world.obey(found)
    world.is_silent()


def test_a_simulator_with_too_much_to_do(world: Any) -> None:
    world.tool("pub", "-r", "10", "/husky0/velocity_cmd", "geometry_msgs/Twist", "{}")
    sim = world.node("sim", "--world", "husky", "--rate", "500")
    found = world.finds("slow-simulator", "/morse", "not 500", "too much to do", wait="0.8s")
    assert found.severity == "warning"
    world.end(sim)
    world.node("sim", "--world", "husky")
    world.is_silent()


def test_simulated_time_that_is_slow(world: Any) -> None:
    clock = (
        "m = Clock(); m.clock.sec, m.clock.nsec = divmod(number * 5_000_000, 10**9);"
        " bus.publish('/clock', m.encode())"
    )
    sender = world.sends(clock)
    world.finds("slow-simulator", sender.pid, "Simulated time passes at 0.")
    world.end(sender)
    world.sends(clock, 0.005)
    world.is_silent()
