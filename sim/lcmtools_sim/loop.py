"""The simulator's loop: receive commands, do one step, publish messages, wait for the next step."""

from collections.abc import Callable

from lcmtools_sim.bridge import Bridge
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation

_PAUSED_WAIT = 0.1  # [s] the longest delay of a request to end, while paused


class Loop:
    """Runs a simulation: by the wall clock, or step by step while it is paused.

    It ends when ``go_on`` returns False, and after ``last_step``, if that is given. While it is
    ``paused``, it waits for ``step``. ``let_step`` is called before each step with a function; it
    waits until the step may be done or the function returns False; True means a long wait.
    """

    def __init__(
        self,
        simulation: Simulation,
        bridge: Bridge,
        pacer: Pacer,
        *,
        go_on: Callable[[], bool],
        last_step: int | None = None,
        let_step: Callable[[Callable[[], bool]], bool] = lambda _: False,
    ) -> None:
        self.paused = False
        self.is_stepping = False  # True during ``step``, for code called in ``let_step``
        self._simulation, self._bridge, self._pacer = simulation, bridge, pacer
        self._go_on, self._last_step, self._let_step = go_on, last_step, let_step
        self._fell_behind = False

    def run(self) -> None:
        """Run until it should end."""
        while True:
            self._bridge.receive(_PAUSED_WAIT if self.paused else 0.0)
            if not self._may_go_on():
                return
            waited = self._let_step(lambda: self._may_go_on() and not self.paused)
            if self.paused or waited:
                self._pacer.restart()
            if self._may_go_on() and not self.paused:
                self._step()
                self._wait()

    def pause(self) -> None:
        """Stand still from now on; the clock's last message then has this time."""
        self.paused = True
        self._bridge.publish_clock()

    def step(self, count: int) -> int:
        """Do a number of steps without waiting; return the number of steps done.

        The clock's last message then has the time of the last step.
        """
        self._bridge.find_subscribers()
        done, self.is_stepping = 0, True
        try:
            while done < count and self._may_go_on():
                self._let_step(self._may_go_on)
                self._step()
                done += 1
        finally:
            self.is_stepping = False
        self._bridge.publish_clock()
        return done

    def set_rate(self, rate: float) -> None:
        """Set the rate of simulated time relative to real time; 0 for as fast as possible."""
        self._pacer.period = self._simulation.scene.dt / rate if rate else 0.0
        self._pacer.restart()
        self._fell_behind = False

    def _may_go_on(self) -> bool:
        left = self._last_step is None or self._simulation.steps < self._last_step
        return left and self._go_on()

    def _step(self) -> None:
        self._bridge.publish(self._simulation.step())

    def _wait(self) -> None:
        dropped = self._pacer.wait(lambda: self._go_on() and not self.paused, self._bridge.receive)
        if dropped and not self._fell_behind:
            self._fell_behind = True
            what = f"the computer is too slow for this rate: {dropped:.2f} s were dropped"
            then = "simulated time falls behind from now on; a lower --rate keeps it even"
            self._bridge.warn(f"{what}, and {then}")
