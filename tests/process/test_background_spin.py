"""Nodes that spin in the background, and signals."""

import signal

import pytest

_SCRIPT = """
import sys, time
import lcmtools
from lcmtools.types.std_msgs import String

lcmtools.init([], handle_signals="--handle" in sys.argv)
node = lcmtools.Node("notebook")
ticks = []
spin = lcmtools.spin_in_background(node)
node.create_timer(0.01, lambda: ticks.append(1))
if "--shutdown" in sys.argv:
    node.create_timer(0.01, lcmtools.shutdown)
    while spin.is_running():
        time.sleep(0.01)
try:
    print("ready", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    count = len(ticks)
    while spin.is_running() and len(ticks) == count:
        time.sleep(0.01)
    print("interrupted,", "goes on" if spin.is_running() else "ended", flush=True)
lcmtools.shutdown()
print("running" if spin.is_running() else "stopped", flush=True)
"""


@pytest.mark.parametrize(
    ("options", "result"),
    [
        ([], "interrupted, goes on"),
        (["--handle"], "interrupted, ended"),
        (["--shutdown"], "interrupted, ended"),
        (["--handle", "--shutdown"], "interrupted, ended"),
    ],
)
def test_ctrl_c_in_the_main_thread(start_python, bus_url, options, result):
    program = start_python(_SCRIPT, *options, LCM_DEFAULT_URL=bus_url)
    program.wait_for("ready")
    program.send_signal(signal.SIGINT)
    assert program.wait() == 0
    assert program.lines[-2:] == [result, "stopped"]
