"""Between the simulation and the bus: the only module that knows nodes, topics and publishers."""

from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.errors import ValueMismatch
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.robot import Robot
from lcmtools_sim.simulation import Sample, Simulation

Command = JointState | Twist

_TYPES: dict[bool, tuple[type[Command], ...]] = {
    False: (JointState, Twist),
    True: (Twist, JointState),
}
"""What a command topic takes, the declared type first; by whether that is Twist."""


class Bridge:
    """Takes commands from the bus to the robots, and samples from the simulation to the bus.

    Args:
        node: The simulator's node.
        simulation: What is simulated.
    """

    def __init__(self, node: Node, simulation: Simulation) -> None:
        self._node = node
        self._complaints: set[str] = set()
        self._publishers = {
            topic: node.create_publisher(message_type, topic)
            for topic, message_type in simulation.topics().items()
        }
        for robot in simulation.robots:
            self._subscribe(robot)

    def receive(self) -> None:
        """Hand over the commands that have come; never waits."""
        spin_once(self._node, 0.0)

    def publish(self, samples: list[Sample]) -> None:
        """Send a step's messages."""
        for sample in samples:
            self._publishers[sample.topic].publish(sample.message)

    def warn(self, text: str) -> None:
        """Log a warning of the simulator."""
        self._node.get_logger().warning(text)

    def _subscribe(self, robot: Robot) -> None:
        prefix = robot.namespace.rstrip("/")
        group = f"wheel command of {robot.namespace}"
        for command in robot.model.commands:
            topic = f"{prefix}/{command.name}"
            callback = self._commander(robot, self._node.resolve_name(topic))
            types = _TYPES[command.is_twist]
            self._node.create_subscription(types, topic, callback, group=group)

    def _commander(self, robot: Robot, topic: str) -> Callable[[Command], None]:
        """The callback of one command topic: obeys, or says once why not."""

        def command(message: Command) -> None:
            try:
                robot.command(message)
            except ValueMismatch as error:
                self._complain(f"{topic}: command ignored: {error}")
            else:
                self._complaints.clear()

        return command

    def _complain(self, text: str) -> None:
        """Warn of a bad command, once until a good one has come: a publisher repeats its fault."""
        if text not in self._complaints:
            self._complaints.add(text)
            self.warn(text)
