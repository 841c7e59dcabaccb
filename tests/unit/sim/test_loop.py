"""The loop's order of things, and when it ends."""

from lcmtools_sim.loop import Loop
from lcmtools_sim.scene import Scene
from lcmtools_sim.schedule import Pacer


class Steps:
    """A simulation that only counts."""

    def __init__(self, log):
        self.steps = 0
        self.log = log
        self.scene = Scene("counted")

    def step(self):
        """Count."""
        self.steps += 1
        self.log.append("step")
        return []


class Log:
    """A context that records its calls."""

    def __init__(self):
        self.lines = []

    def receive(self, timeout=0.0):
        """Write it down; nothing is waited for."""
        del timeout
        self.lines.append("receive")

    def find_subscribers(self):
        """Write it down."""
        self.lines.append("look")

    def publish(self, samples):
        """Write it down."""
        self.lines.append(f"publish {len(samples)}")

    def publish_clock(self):
        """Write it down."""
        self.lines.append("clock")

    def warn(self, text):
        """Write it down."""
        self.lines.append(f"warn: {text}")


def no_wait():
    return Pacer(0.0)


def test_commands_come_before_the_step_and_messages_after_it():
    log = Log()
    Loop(Steps(log.lines), log, no_wait(), go_on=lambda: True, last_step=2).run()
    assert log.lines == [*["receive", "step", "publish 0"] * 2, "receive"]


def test_it_ends_when_it_is_asked_to():
    log = Log()
    simulation = Steps(log.lines)
    Loop(simulation, log, no_wait(), go_on=lambda: simulation.steps < 7).run()
    assert simulation.steps == 7


def test_a_slow_computer_is_warned_of_once():
    log = Log()
    wall = iter(range(100))  # every look at the clock is a second later
    pacer = Pacer(0.01, now=lambda: float(next(wall)), sleep=lambda _: None)
    Loop(Steps(log.lines), log, pacer, go_on=lambda: True, last_step=5).run()
    warnings = [line for line in log.lines if line.startswith("warn")]
    assert len(warnings) == 1
    assert "0.99 s were dropped" in warnings[0]


class Caller(Log):
    """Surroundings from which a call comes while the next step is far away."""

    def __init__(self):
        super().__init__()
        self.calls = []

    def receive(self, timeout=0.0):
        """Hand over the next call."""
        super().receive(timeout)
        if self.calls:
            self.calls.pop(0)()


def test_calls_are_answered_while_a_slow_rate_waits_for_its_next_step():
    # A millionth of real time: 10 000 s to the next step.
    surroundings, slept = Caller(), []
    pacer = Pacer(1e4, now=lambda: sum(slept), sleep=slept.append)
    simulation = Steps(surroundings.lines)
    loop = Loop(simulation, surroundings, pacer, go_on=lambda: True, last_step=3)
    surroundings.calls = [lambda: None, lambda: loop.set_rate(0)]
    loop.run()
    assert simulation.steps == 3
    assert sum(slept) < 1.0


def test_a_pause_ends_the_wait_for_a_slow_step():
    surroundings, slept = Caller(), []
    pacer = Pacer(1e4, now=lambda: sum(slept), sleep=slept.append)
    simulation = Steps(surroundings.lines)
    loop = Loop(simulation, surroundings, pacer, go_on=lambda: not loop.paused)
    surroundings.calls = [lambda: None, lambda: setattr(loop, "paused", True)]
    loop.run()
    assert simulation.steps == 1
    assert sum(slept) < 1.0


def test_it_finds_subscribers_before_requested_steps_and_publishes_the_clock_after_them():
    log = Log()
    Loop(Steps(log.lines), log, no_wait(), go_on=lambda: True).step(2)
    assert log.lines == ["look", *["step", "publish 0"] * 2, "clock"]


def test_each_step_is_let_and_a_long_wait_for_that_is_no_debt():
    log, wall = Log(), [0.0]

    def let_step(_):
        log.lines.append("let")
        wall[0] += 5.0
        return True

    pacer = Pacer(0.01, now=lambda: wall[0], sleep=lambda s: wall.__setitem__(0, wall[0] + s))
    loop = Loop(Steps(log.lines), log, pacer, go_on=lambda: True, last_step=3, let_step=let_step)
    loop.run()
    assert [line for line in log.lines if line in ("let", "step")] == ["let", "step"] * 3
    assert not [line for line in log.lines if line.startswith("warn")]


def test_a_pause_publishes_the_time_at_which_it_stands():
    log = Log()
    loop = Loop(Steps(log.lines), log, no_wait(), go_on=lambda: True)
    loop.pause()
    assert (loop.paused, log.lines) == (True, ["clock"])
