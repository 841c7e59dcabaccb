"""The test bench's wait for a program's first message, and its look at the bus, without either."""

from types import SimpleNamespace

import pytest

import lcmtools
from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks import test_bench
from lcmtools.labs.checks.observations import BusLook, Failure, Wire
from lcmtools.labs.checks.program_rows import first
from lcmtools.labs.checks.results import CheckResult

ROW = CheckResult("commands the robot", "messages", "they come", is_ok=True)
NODE = "/husky0/simple_controller"
INPUTS = [Wire("/husky0/odometry"), Wire("/husky0/desired_velocity")]
RAISING = BusLook([NODE], subscriptions=INPUTS, failures=[Failure("KeyError", "'a'", count=9)])
STARTING = BusLook([NODE], subscriptions=INPUTS)


class Bench(test_bench.TestBench):
    """A bench of a program that runs and is silent; it notes how long it would wait [s]."""

    def __init__(self):
        super().__init__(LABS["husky"], LABS["husky"].programs[0])
        self.waits = list[float]()
        program = SimpleNamespace(code=None, pid=1, printed=str, was_interrupted=False)
        self.program = program
        self.node = None

    def wait(self, _condition, timeout):
        """Wait in vain."""
        self.waits.append(round(timeout, 1))
        return False


@pytest.fixture
def spun(monkeypatch):
    """The actions in their order."""
    done = []
    monkeypatch.setattr(
        lcmtools, "spin_once", lambda _: done.append("messages taken"), raising=False
    )
    return done


@pytest.mark.usefixtures("spun")
@pytest.mark.parametrize(("look", "is_patient"), [(RAISING, False), (STARTING, True)])
def test_a_cause_that_time_does_not_mend_is_told_early(look, monkeypatch, *, is_patient):
    monkeypatch.setattr(test_bench, "look_at_bus", lambda *_: look)
    bench = Bench()
    assert not first(bench, list, 10.0, ROW).is_ok
    assert bench.waits[0] == 3.0
    assert (bench.waits[1] > 1.0) is is_patient


def test_messages_that_came_during_a_look_are_taken_before_the_next_row(spun, monkeypatch):
    monkeypatch.setattr(test_bench, "look_at_bus", lambda *_: spun.append("look") or STARTING)
    bench = Bench()
    bench.observe()
    bench.observe()
    assert spun == ["look", "messages taken"]
