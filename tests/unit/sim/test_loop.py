"""The loop's order of things, and when it ends."""

from lcmtools_sim.loop import run
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Sample


class Steps:
    """A simulation that only counts."""

    def __init__(self, log: list[str]) -> None:
        self.steps = 0
        self.log = log
        self.open = True

    def is_open(self) -> bool:
        """Whether its window is there."""
        return self.open

    def step(self) -> list[Sample]:
        """Count."""
        self.steps += 1
        self.log.append("step")
        return []


class Log:
    """Surroundings that write down what they are asked for."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def receive(self) -> None:
        """Write it down."""
        self.lines.append("receive")

    def publish(self, samples: list[Sample]) -> None:
        """Write it down."""
        self.lines.append(f"publish {len(samples)}")

    def warn(self, text: str) -> None:
        """Write it down."""
        self.lines.append(f"warn: {text}")


def no_wait() -> Pacer:
    return Pacer(0.0)


def test_commands_come_before_the_step_and_messages_after_it() -> None:
    log = Log()

    run(Steps(log.lines), log, no_wait(), go_on=lambda: True, steps=2)

    assert log.lines == ["receive", "step", "publish 0"] * 2


def test_it_ends_when_it_is_asked_to() -> None:
    log = Log()
    simulation = Steps(log.lines)

    run(simulation, log, no_wait(), go_on=lambda: simulation.steps < 7)

    assert simulation.steps == 7


def test_it_ends_without_a_step_when_the_window_is_closed() -> None:
    log = Log()
    simulation = Steps(log.lines)
    simulation.open = False

    run(simulation, log, no_wait(), go_on=lambda: True)

    assert log.lines == ["receive"]


def test_a_slow_computer_is_told_once() -> None:
    log = Log()
    wall = iter(range(100))  # every look at the clock is a second later

    pacer = Pacer(0.01, now=lambda: float(next(wall)), sleep=lambda _: None)
    run(Steps(log.lines), log, pacer, go_on=lambda: True, steps=5)

    warnings = [line for line in log.lines if line.startswith("warn")]
    assert len(warnings) == 1
    assert "0.99 s were dropped" in warnings[0]
