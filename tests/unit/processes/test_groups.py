"""Remains of a group of processes."""

import os
import signal
import subprocess

from lcmtools.processes.reaper import is_gone, send


def test_group_is_gone_when_only_what_has_ended_is_left(wait_until):
    process = subprocess.Popen(["sleep", "100"], start_new_session=True)  # noqa: S607
    try:
        assert not is_gone(process.pid)
        assert send(process.pid, signal.SIGKILL)
        wait_until(lambda: is_gone(process.pid))
        assert os.path.exists(f"/proc/{process.pid}")  # noqa: PTH110 - nobody has looked at its end yet
    finally:
        process.wait()
    assert is_gone(process.pid)


def test_no_signal_goes_to_the_own_group():
    assert not send(0, signal.SIGKILL)
