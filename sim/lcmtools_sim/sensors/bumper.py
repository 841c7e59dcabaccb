"""A bumper around the whole robot."""

from collections.abc import Collection, Mapping, Sequence

from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.types.gazebo_msgs import ContactsState, ContactState
from lcmtools.types.geometry_msgs import Vector3, Wrench
from lcmtools_sim.geometry import Vector, axes, components, scaled, subtract
from lcmtools_sim.sensors.sensor import Contact, RobotState, SensorContext, SensorMount, fill_header


class BumperSensor:
    """gazebo_msgs/ContactsState in base_link: one state for each touched body.

    The ground is not counted. Forces are those of the last step, without torque.
    """

    outputs: Mapping[str, type[Message]] = {"": ContactsState}

    def __init__(self, mount: SensorMount, context: SensorContext) -> None:
        del mount  # it measures the whole robot
        self._context = context
        self._frame = context.frame("base_link")

    def sample(self, state: RobotState, wanted: Collection[str]) -> Mapping[str, bytes]:
        """Return the contacts after one step."""
        del wanted
        message = ContactsState()
        fill_header(message.header, state.time, self._frame)
        bodies: dict[str, list[Contact]] = {}
        for contact in self._context.world.contacts(self._context.body):
            bodies.setdefault(contact.name, []).append(contact)
        message.states = [self._state(name, found, state) for name, found in bodies.items()]
        return {"": encode(message)}

    def _state(self, name: str, contacts: Sequence[Contact], state: RobotState) -> ContactState:
        """Return all contacts with one body."""
        frame = axes(state.rotation)
        message = ContactState()
        message.collision1_name, message.collision2_name = self._context.namespace, name
        normals = [components(contact.normal, frame) for contact in contacts]
        forces = [scaled(n, contact.force) for n, contact in zip(normals, contacts, strict=True)]
        message.contact_positions = [
            _vector(components(subtract(contact.position, state.position), frame))
            for contact in contacts
        ]
        message.contact_normals = [_vector(normal) for normal in normals]
        message.depths = [contact.depth for contact in contacts]
        message.wrenches = [_wrench(force) for force in forces]
        x, y, z = (sum(values) for values in zip(*forces, strict=True))
        message.total_wrench = _wrench((x, y, z))
        return message


def _wrench(force: Vector) -> Wrench:
    wrench = Wrench()
    wrench.force = _vector(force)
    return wrench


def _vector(values: Vector) -> Vector3:
    vector = Vector3()
    vector.x, vector.y, vector.z = values
    return vector
