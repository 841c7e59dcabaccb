"""A bumper around the whole robot: what it touches, and how hard."""

from collections.abc import Collection, Mapping

from lcmtools.messages.registry import Message
from lcmtools.types.gazebo_msgs import ContactsState, ContactState
from lcmtools.types.geometry_msgs import Vector3, Wrench
from lcmtools_sim.rotation import Vector, axes, components, scaled, subtract
from lcmtools_sim.sensors.mount import SensorMount
from lcmtools_sim.sensors.sensor import Carrier, Contact, RobotState, fill_header


class BumperSensor:
    """gazebo_msgs/ContactsState in base_link: one state for each thing that is touched.

    Standing on the ground is no touch. Forces are those of the last step, without torque.

    Args:
        mount: Where it publishes.
        carrier: The robot.
    """

    outputs: Mapping[str, type[Message]] = {"": ContactsState}

    def __init__(self, mount: SensorMount, carrier: Carrier) -> None:
        del mount  # it measures the whole robot
        self._around = carrier.around
        self._name = carrier.namespace
        self._frame = carrier.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, Message]:
        """What is touched after one step."""
        del wanted
        message = ContactsState()
        fill_header(message.header, state.time, self._frame)
        touched: dict[str, ContactState] = {}
        for contact in self._around.touching():
            _add(touched.setdefault(contact.name, self._touch(contact.name)), contact, state)
        message.states = list(touched.values())
        return {"": message}

    def _touch(self, name: str) -> ContactState:
        touch = ContactState()
        touch.collision1_name, touch.collision2_name = self._name, name
        return touch


def _add(touch: ContactState, contact: Contact, state: RobotState) -> None:
    """Add one place to a touch."""
    frame = axes(state.rotation)
    normal = components(contact.normal, frame)
    force = scaled(normal, contact.force)
    touch.contact_positions.append(
        _vector(components(subtract(contact.position, state.position), frame))
    )
    touch.contact_normals.append(_vector(normal))
    touch.depths.append(contact.depth)
    wrench = Wrench()
    wrench.force = _vector(force)
    touch.wrenches.append(wrench)
    total = touch.total_wrench.force
    total.x, total.y, total.z = total.x + force[0], total.y + force[1], total.z + force[2]


def _vector(values: Vector) -> Vector3:
    vector = Vector3()
    vector.x, vector.y, vector.z = values
    return vector
