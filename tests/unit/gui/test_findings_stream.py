"""The stream of wtf's findings."""

import subprocess
import threading

from fixtures.gui import FakeSource

from lcmtools.gui.streams import findings
from lcmtools.gui.streams.findings import DoctorFindings


def test_closing_ends_a_look_that_is_just_being_started(monkeypatch):
    """The window may end right after: nobody else would end the look's process."""
    popen = subprocess.Popen
    starts, may_go_on = threading.Event(), threading.Event()
    looks = []

    def start_slowly(*_, **streams):
        looks.append(popen(["sleep", "60"], **streams))
        starts.set()
        assert may_go_on.wait(10)
        return looks[0]

    monkeypatch.setattr(findings.subprocess, "Popen", start_slowly)
    stream = DoctorFindings(FakeSource())
    assert starts.wait(10)
    threading.Timer(0.1, may_go_on.set).start()
    stream.close()
    assert may_go_on.is_set()
    assert looks[0].wait(10) < 0
