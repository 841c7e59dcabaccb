"""Where a sensor sits on a robot, how often it measures, and what it measures with."""

from dataclasses import dataclass

from lcmtools_sim.pose import ORIGIN, Pose


class Settings:
    """The base of every sensor's settings: a frozen dataclass, one a kind of sensor.

    Its fields are what a world file may say of such a sensor; see lcmtools_sim.sensors.settings.
    """

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class SensorMount:
    """A sensor that a robot carries.

    Attributes:
        kind: A key of sensors.SENSORS.
        topic: What it publishes on, or what the names of its several outputs begin with; relative
            to the robot's namespace, or absolute.
        rate: [Hz] at most one measurement a step.
        pose: Of the sensor in base_link; what measures the whole robot has none.
        frame: The name of its frame, to be prefixed by the namespace; "" for the kind's usual one.
        settings: What the kind has; None for its defaults.
        always: Measure also when nobody can be listening.
    """

    kind: str
    topic: str
    rate: float
    pose: Pose = ORIGIN
    frame: str = ""
    settings: Settings | None = None
    always: bool = False
