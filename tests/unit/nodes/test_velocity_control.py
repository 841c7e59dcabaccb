"""The control law against a simulated robot: no bus, no clock.

The plant is the Husky as its motors show it: each side follows effort x 1 m/s as a first-order lag
of 0.15 s, by 3 m/s^2 at most, and the body turns about an effective track of 1.0702 m.
"""

import math
from dataclasses import dataclass, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.labs.nodes.velocity_control import Gains, SideControl, Velocity, VelocityControl

STEP = 1 / 240
"""Of the plant [s]."""
RATES = [20, 50, 60, 100]
"""Of the odometry [Hz]."""
SETTLED = 1.5
"""Seconds after which the velocity must be the desired one."""


@dataclass(slots=True)
class Plant:
    """The robot; see above for the values that a Husky has."""

    lag: float = 0.15
    full_speed: float = 1.0
    track: float = 1.0702
    delay: float = 0.0
    left: float = 0.0
    right: float = 0.0

    def velocity(self):
        """The reading of a perfect odometer."""
        return Velocity((self.left + self.right) / 2, (self.right - self.left) / self.track)

    def advance(self, efforts):
        """Go on for one STEP."""
        self.left += self._change(efforts[0], self.left)
        self.right += self._change(efforts[1], self.right)

    def _change(self, effort, speed):
        target = max(-1.0, min(1.0, effort)) * self.full_speed
        change = (target - speed) * STEP / (self.lag + STEP)
        return max(-3.0 * STEP, min(3.0 * STEP, change))


def _drive(plant, control, desired, rate, start=0.0):
    """Velocities in each step of four seconds, the odometry coming at a rate [Hz]."""
    applied = (0.0, 0.0)
    waiting = []
    velocities = []
    samples = 0
    for i in range(round(4 / STEP)):
        now = i * STEP
        if now >= samples / rate:
            samples += 1
            efforts = control.efforts(desired, plant.velocity(), round((start + now) * 1e9))
            waiting.append((now + plant.delay, efforts))
        while waiting and waiting[0][0] <= now:
            applied = waiting.pop(0)[1]
        plant.advance(applied)
        velocities.append(plant.velocity())
    return velocities


def _assert_keeps(velocities, desired):
    """From SETTLED on: forward within 5 % or 5 mm/s, turn rate within 10 % or 10 mrad/s."""
    for velocity in velocities[round(SETTLED / STEP) :]:
        assert velocity.forward == pytest.approx(desired.forward, rel=0.05, abs=0.005)
        assert velocity.turn_rate == pytest.approx(desired.turn_rate, rel=0.1, abs=0.01)


DESIRED = [
    Velocity(0.1, 0.0),
    Velocity(0.1, 0.1),
    Velocity(0.5, 0.0),
    Velocity(0.5, 0.3),
    Velocity(0.5, -0.8),
    Velocity(1.0, 0.0),
    Velocity(0.0, 0.1),
    Velocity(0.0, 1.5),
    Velocity(-0.1, -0.1),
    Velocity(-1.0, 0.0),
]


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("desired", DESIRED)
def test_robot_comes_to_the_desired_velocity_and_keeps_it(desired, rate):
    velocities = _drive(Plant(), VelocityControl(Gains()), desired, rate)
    _assert_keeps(velocities, desired)
    last_second = velocities[-round(1 / STEP) :]
    for name in ("forward", "turn_rate"):  # no oscillation remains: 1 mm/s and 1 mrad/s
        values = [getattr(velocity, name) for velocity in last_second]
        assert max(values) - min(values) < 0.001


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("speed", [0.1, 0.5, 0.9, 1.0, -0.5])
def test_speed_does_not_overshoot(speed, rate):
    velocities = _drive(Plant(), VelocityControl(Gains()), Velocity(speed, 0.0), rate)
    assert max(abs(velocity.forward) for velocity in velocities) < abs(speed) * 1.01


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(
    "plant",
    [
        Plant(lag=0.05),
        Plant(lag=0.3),
        Plant(full_speed=0.8),
        Plant(full_speed=1.2),
        Plant(track=0.8),
        Plant(track=1.4),
        Plant(delay=0.03),
    ],
    ids=str,
)
def test_robot_that_differs_from_the_model_is_controlled_all_the_same(plant, rate):
    desired = Velocity(0.5, 0.3)
    robot = replace(plant)  # each test its own
    _assert_keeps(_drive(robot, VelocityControl(Gains()), desired, rate), desired)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("before", [Velocity(1.0, 0.0), Velocity(-0.5, 0.5), Velocity(0.1, 0.1)])
def test_robot_stops_and_no_effort_is_left_over(before, rate):
    plant, control = Plant(), VelocityControl(Gains())
    _drive(plant, control, before, rate)
    velocities = _drive(plant, control, Velocity(0.0, 0.0), rate, start=4.0)
    _assert_keeps(velocities, Velocity(0.0, 0.0))
    assert control.efforts(Velocity(0.0, 0.0), plant.velocity(), 9 * 10**9) == (0.0, 0.0)
    assert control.efforts(Velocity(0.2, 0.0), Velocity(0.0, 0.0), 9 * 10**9) == (0.2, 0.2)


@pytest.mark.parametrize("rate", RATES)
def test_robot_turns_round_from_full_speed_ahead_to_full_speed_astern(rate):
    plant, control = Plant(), VelocityControl(Gains())
    for start, speed in ((0.0, 1.0), (4.0, -1.0)):
        desired = Velocity(speed, 0.0)
        _assert_keeps(_drive(plant, control, desired, rate, start), desired)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("desired", [Velocity(1.0, 0.5), Velocity(1.0, -3.0), Velocity(-5.0, 1.0)])
def test_velocity_out_of_reach_is_driven_slower_on_the_same_curve(desired, rate):
    plant, control = Plant(), VelocityControl(Gains())
    velocities = _drive(plant, control, desired, rate)
    end = velocities[-1]
    assert end.forward / end.turn_rate == pytest.approx(desired.forward / desired.turn_rate, 0.02)
    assert max(abs(plant.left), abs(plant.right)) == pytest.approx(1.0, abs=0.01)
    feasible = Velocity(0.3, 0.0)  # and nothing has been wound up meanwhile
    _assert_keeps(_drive(plant, control, feasible, rate, start=4.0), feasible)


def test_robot_that_is_held_does_not_wind_the_controller_up():
    control = SideControl()
    for _ in range(1000):
        assert control.effort(0.5, 0.02, Gains()) <= 1.0
    speed, fastest = 0.0, 0.0
    for _ in range(200):
        effort = control.effort(0.5 - speed, 0.02, Gains())
        speed += (effort - speed) * 0.02 / 0.17
        fastest = max(fastest, speed)
    assert speed == pytest.approx(0.5, abs=0.001)
    assert fastest < 0.75


@pytest.mark.parametrize(
    ("times", "integrated"),
    [
        ([5.0, 5.02], 0.02),
        ([5.0, 5.0, 5.0], 0.0),
        ([5.0, 65.0], 0.1),
        ([5.0, 5.02, 1.0], 0.0),
        ([5.0, 5.02, 1.0, 1.02], 0.02),
    ],
    ids=["a step", "standing still", "a gap", "set back", "on from there"],
)
def test_only_sane_steps_of_time_are_integrated(times, integrated):
    control = VelocityControl(Gains(kp=0.0, ki=1.0))
    efforts = [
        control.efforts(Velocity(1.0, 0.0), Velocity(0.0, 0.0), round(time * 1e9)) for time in times
    ]
    assert efforts[-1] == pytest.approx((integrated, integrated))


NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
VELOCITIES = st.builds(Velocity, NUMBERS, NUMBERS)


@given(st.lists(st.tuples(VELOCITIES, VELOCITIES, st.integers(0, 2**62)), max_size=6))
def test_efforts_stay_within_the_limits_whatever_comes(calls):
    control = VelocityControl(Gains())
    for desired, measured, time in calls:
        for effort in control.efforts(desired, measured, time):
            assert -1.0 <= effort <= 1.0


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
def test_velocity_knows_whether_it_can_be_calculated_with(broken):
    assert Velocity(1.0, -2.0).is_finite()
    assert not Velocity(broken, 0.0).is_finite()
    assert not Velocity(0.0, broken).is_finite()
