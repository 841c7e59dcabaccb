"""A node that a recording is played to: it doubles numbers, or fails as its parameters say."""

import os
import sys
import threading
import time
from pathlib import Path

import lcmtools
from lcmtools import Node
from lcmtools.types.std_msgs import Float64, Header

_WRONG = ("drop_at", "late_at", "raise_at", "hang_at", "exit_at", "subscribe_at", "thread_at")


class Doubler(Node):
    """Publishes on "out" twice what comes on "in"; with a timer, the time on "ticks"."""

    def __init__(self):
        super().__init__("doubler")
        self._gain = self.declare_parameter("gain", 2.0)
        self._at = {name: self.declare_parameter(name, 0) for name in _WRONG}
        self._period = self.declare_parameter("period", 0.0)
        self._count = 0
        self._kept = []
        self._out = self.create_publisher(Float64, "out")
        self.create_subscription(Float64, "in", self._double)
        if self._period.value:
            self._ticks = self.create_publisher(Header, "ticks")
            self.create_timer(self._period.value, self._tick)

    def _double(self, message):
        self._count += 1
        is_now = {name: self._count == at.value for name, at in self._at.items()}
        self._go_on(is_now)
        if is_now["raise_at"]:
            raise ValueError("too large")
        if is_now["hang_at"]:
            Path(os.environ.get("MARK", os.devnull)).touch()
            time.sleep(1000)
        if is_now["exit_at"]:
            sys.stdout.write("the end is near\n")
            sys.stdout.flush()
            os._exit(3)
        if is_now["late_at"]:
            self._kept.append(message.data)
        elif not is_now["drop_at"]:
            for data in (*self._kept, message.data):
                self._out.publish(Float64(data=data * self._gain.value))
            self._kept.clear()

    def _go_on(self, is_now):
        if is_now["thread_at"]:
            threading.Thread(target=chatter, args=[self], daemon=True).start()
        if is_now["subscribe_at"]:
            self._echo = self.create_publisher(Float64, "echo")
            self.create_subscription(Float64, "out", self._echo.publish)

    def _tick(self):
        header = Header()
        header.stamp.sec, header.stamp.nsec = divmod(self.get_clock().now(), 10**9)
        self._ticks.publish(header)


def chatter(node):
    """Publish by the computer's clock."""
    publisher = node.create_publisher(Float64, "chatter")
    while lcmtools.ok():
        publisher.publish(Float64(data=1.0))
        time.sleep(0.05)


def main():
    """Run it until Ctrl-C; arguments let a "thread" publish, or a "loop" that does not spin."""
    rest = lcmtools.init()
    node = Doubler()
    if "thread" in rest:
        threading.Thread(target=chatter, args=[node], daemon=True).start()
    if "loop" in rest:
        chatter(node)
    lcmtools.spin(node)
    lcmtools.shutdown()


if __name__ == "__main__":
    main() if "never" not in sys.argv else time.sleep(1000)
