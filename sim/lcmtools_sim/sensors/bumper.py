"""A bumper around the whole robot: what it touches, and how hard."""

from collections.abc import Collection, Mapping, Sequence

from lcmtools.messages.codec import encode
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

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """What is touched after one step."""
        del wanted
        message = ContactsState()
        fill_header(message.header, state.time, self._frame)
        touched: dict[str, list[Contact]] = {}
        for contact in self._around.touching():
            touched.setdefault(contact.name, []).append(contact)
        message.states = [self._touch(name, contacts, state) for name, contacts in touched.items()]
        return {"": encode(message)}

    def _touch(self, name: str, contacts: Sequence[Contact], state: RobotState) -> ContactState:
        """Everything about one thing that is touched."""
        frame = axes(state.rotation)
        touch = ContactState()
        touch.collision1_name, touch.collision2_name = self._name, name
        normals = [components(contact.normal, frame) for contact in contacts]
        forces = [
            scaled(normal, contact.force) for normal, contact in zip(normals, contacts, strict=True)
        ]
        touch.contact_positions = [
            _vector(components(subtract(contact.position, state.position), frame))
            for contact in contacts
        ]
        touch.contact_normals = [_vector(normal) for normal in normals]
        touch.depths = [contact.depth for contact in contacts]
        touch.wrenches = [_wrench(force) for force in forces]
        x, y, z = (sum(parts) for parts in zip(*forces, strict=True))
        touch.total_wrench = _wrench((x, y, z))
        return touch


def _wrench(force: Vector) -> Wrench:
    wrench = Wrench()
    wrench.force = _vector(force)
    return wrench


def _vector(values: Vector) -> Vector3:
    vector = Vector3()
    vector.x, vector.y, vector.z = values
    return vector
