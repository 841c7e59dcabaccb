"""The engine: what collides, falls and is pushed. The only module that knows pybullet.

It builds the ground, things and robot bodies (by bodies.py), steps them, tells and sets how they
move, and lets sensors look at them. What wheels and tyres do is not known here: a robot's body has
no friction, the tyres (tyres.py) pull it.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from types import ModuleType
from typing import NamedTuple, cast

from lcmtools.errors import MissingExtra
from lcmtools_sim.bodies import BodyMaker
from lcmtools_sim.meshes_in_view import Angles, MeshesInView, unturned
from lcmtools_sim.pose import Pose
from lcmtools_sim.robots.model import Body
from lcmtools_sim.rotation import Quaternion, Vector, add, multiply, turn
from lcmtools_sim.scene import Scene, Thing
from lcmtools_sim.sensors.sensor import Contact
from lcmtools_sim.shapes import Part
from lcmtools_sim.silence import silenced

_RECOVERY = 12.0
"""[1/s] How fast bodies come out of each other; faster, what is pushed is shaken aside."""


class Motion(NamedTuple):
    """How a body is and moves, in the world frame. A tuple, for it is made every step.

    Attributes:
        position: Of the centre of mass [m].
        rotation: Of the body.
        velocity: Of the centre of mass [m/s].
        angular_velocity: Angular velocity [rad/s].
    """

    position: Vector
    rotation: Quaternion
    velocity: Vector
    angular_velocity: Vector


class World:
    """One Bullet world, built from a scene's ground and things; robots are added to it.

    A context manager: it owns its connection to the engine.

    Args:
        scene: Step, gravity, ground and things.
        window: Whether to show it; needs a display (see display.py: without one, Bullet ends the
            whole process).

    Raises:
        MissingExtra: pybullet is not installed.
    """

    def __init__(self, scene: Scene, *, window: bool = False) -> None:
        with silenced():
            self._bullet = _import_pybullet()
            self._client: int = self._bullet.connect(
                self._bullet.GUI if window else self._bullet.DIRECT
            )
            self._window = window
            self._make = BodyMaker(self._bullet, self._client)
            self._build(scene)

    def __enter__(self) -> "World":
        """Use it in a with statement."""
        return self

    def __exit__(self, *_: object) -> None:
        """Give the engine back."""
        self.close()

    def close(self) -> None:
        """Give the engine back; the window closes."""
        with silenced():
            if self._is_connected():
                self._bullet.disconnect(physicsClientId=self._client)

    def is_open(self) -> bool:
        """Whether the engine can go on: a window that the user closes takes it away."""
        return not self._window or self._is_connected()

    def step(self) -> None:
        """Let one dt pass."""
        self._bullet.stepSimulation(physicsClientId=self._client)
        if self._meshes:
            self._meshes.step()

    def motion(self, body: int) -> Motion:
        """How a body is and moves now."""
        bullet, client = self._bullet, self._client
        place = bullet.getBasePositionAndOrientation(body, client)
        return Motion._make(place + bullet.getBaseVelocity(body, client))

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Give a body another velocity [m/s] and angular velocity [rad/s], in the world frame."""
        self._bullet.resetBaseVelocity(body, velocity, angular_velocity, self._client)

    def overlap(self, body: int) -> tuple[float, str]:
        """How deep a body stands in another one [m], and the other's name; (0, "") in none."""
        self._bullet.performCollisionDetection(physicsClientId=self._client)
        return self._deepest(body)

    def overlaps(self) -> list[tuple[Thing, float, str]]:
        """The same of every thing that can move and stands in something."""
        self._bullet.performCollisionDetection(physicsClientId=self._client)
        found = [(thing, *self._deepest(body)) for thing, body in self._things if thing.mass]
        return [(thing, depth, other) for thing, depth, other in found if depth]

    def overlap_at(self, body: int, position: Vector, rotation: Quaternion) -> tuple[float, str]:
        """What ``overlap`` would say with the centre of mass there; the body stays as it is."""
        now = self.motion(body)
        self.place(body, position, rotation)
        found = self.overlap(body)
        self.place(body, now.position, now.rotation)
        self.set_velocity(body, now.velocity, now.angular_velocity)
        return found

    def add(self, thing: Thing) -> int:
        """Put up a thing and return its body's number."""
        body = self._make.thing(thing)
        self._names[body] = thing.name
        if thing.mass:
            self._moving[body] = thing.parts
        else:
            self._fixed += tuple(_placed(part, thing.pose) for part in thing.parts)
        return body

    def add_robot(self, name: str, body: Body, pose: Pose, angles: Angles = unturned) -> int:
        """Put up a robot's body, ``pose`` being that of its base_footprint; return its number.

        A window asks by ``angles`` how far its wheels have turned.
        """
        with self._undrawn():
            number = self._make.robot(body, pose)
            self._names[number] = name
            centre = body.centre_of_mass  # the engine tells where that is
            self._moving[number] = tuple(_lowered(part, centre) for part in body.parts)
            if self._meshes:
                self._meshes.add(number, body.meshes, centre, angles)
                self._look_at(pose)
        return number

    def remove(self, body: int) -> None:
        """Take away a robot."""
        with self._undrawn():
            if self._meshes:
                self._meshes.take_away()
            self._bullet.removeBody(body, physicsClientId=self._client)
            del self._names[body], self._moving[body]
            if self._meshes:
                self._meshes.forget(body)
                self._meshes.show_all()

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a robot's centre of mass elsewhere, at rest."""
        self._bullet.resetBasePositionAndOrientation(body, position, rotation, self._client)
        self.set_velocity(body, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        if self._meshes:
            self._meshes.show(body)

    def reset(self, scene: Scene) -> None:
        """Begin anew with the ground and the things of a scene; robots are gone."""
        with silenced():
            self._bullet.resetSimulation(physicsClientId=self._client)
            self._build(scene)

    def fixed_parts(self) -> tuple[Part, ...]:
        """The shapes that stand for ever, in the world; the same object until one is added."""
        return self._fixed

    def moving_bodies(
        self, but: int | None = None
    ) -> list[tuple[tuple[Part, ...], Vector, Quaternion]]:
        """The bodies that can move (but one): their shapes in a frame, and where that is now."""
        place = self._bullet.getBasePositionAndOrientation
        return [
            (parts, *place(body, self._client))
            for body, parts in self._moving.items()
            if body != but
        ]

    def moving_parts(self, but: int | None = None) -> list[Part]:
        """The shapes of all bodies that can move (but one), in the world now."""
        return [
            _carried(part, position, rotation)
            for parts, position, rotation in self.moving_bodies(but)
            for part in parts
        ]

    def contacts(self, body: int) -> list[Contact]:
        """Where a body touches something that is not the ground, as of the last step."""
        points = self._bullet.getContactPoints(body, physicsClientId=self._client)
        return [
            Contact(self._names[point[2]], point[5], point[7], point[9], -point[8])
            for point in points
            if point[2] != self._ground and point[9] > 0
        ]

    def _deepest(self, body: int) -> tuple[float, str]:
        """The deepest of a body's contacts, as ``overlap`` tells it."""
        contacts = self._bullet.getContactPoints(body, physicsClientId=self._client)
        deepest = min(contacts, key=lambda contact: contact[8], default=None)
        if deepest is None or deepest[8] >= 0:
            return 0.0, ""
        return -deepest[8], self._names[deepest[2]]

    def _is_connected(self) -> bool:
        return bool(self._bullet.isConnected(physicsClientId=self._client))

    def _build(self, scene: Scene) -> None:
        bullet, client = self._bullet, self._client
        bullet.setGravity(0.0, 0.0, -scene.gravity, physicsClientId=client)
        bullet.setTimeStep(scene.dt, physicsClientId=client)
        bullet.setPhysicsEngineParameter(
            # Else what starts on the ground falls for a step into the engine's slop, and bounces.
            contactSlop=0.0,
            contactERP=_RECOVERY * scene.dt,
            # The engine's own are so coarse that crates at rest creep.
            solverResidualThreshold=1e-12,
            warmStartingFactor=1.0,
            physicsClientId=client,
        )
        if self._window:
            bullet.configureDebugVisualizer(bullet.COV_ENABLE_GUI, 0, physicsClientId=client)
        self._names: dict[int, str] = {}
        self._fixed: tuple[Part, ...] = ()
        self._moving: dict[int, tuple[Part, ...]] = {}
        """The shapes of what can move, in the frame that the engine tells of it."""
        self._meshes = MeshesInView(bullet, client, self._make.mesh) if self._window else None
        self._ground = self._make.ground(scene.ground)
        self._names[self._ground] = "the ground"
        with self._undrawn():
            self._things = [(thing, self.add(thing)) for thing in scene.things]

    @contextmanager
    def _undrawn(self) -> Iterator[None]:
        """Let the window wait: it would draw all anew for each body that comes or goes."""
        draw, rendering = self._bullet.configureDebugVisualizer, self._bullet.COV_ENABLE_RENDERING
        draw(rendering, 0, physicsClientId=self._client)
        try:
            yield
        finally:
            draw(rendering, 1, physicsClientId=self._client)

    def _look_at(self, pose: Pose) -> None:
        """Point the window's camera at a place, from behind and above."""
        self._bullet.resetDebugVisualizerCamera(
            cameraDistance=4.0,
            cameraYaw=-60.0,
            cameraPitch=-30.0,
            cameraTargetPosition=(pose.x, pose.y, pose.z),
            physicsClientId=self._client,
        )


def _placed(part: Part, pose: Pose) -> Part:
    """A part of something that stands at a pose, in the frame of that pose."""
    return _carried(part, pose.position, pose.rotation)


def _carried(part: Part, position: Vector, rotation: Quaternion) -> Part:
    place = add(position, turn(part.position, rotation))
    return Part(part.shape, place, multiply(rotation, part.rotation), part.color)


def _lowered(part: Part, height: float) -> Part:
    x, y, z = part.position
    return Part(part.shape, (x, y, z - height), part.rotation, part.color)


def check_installed() -> None:
    """Return if pybullet is there, without importing it.

    Raises:
        MissingExtra: It is not, with what to type.
    """
    if find_spec("pybullet") is None:
        raise _missing_extra()


def _import_pybullet() -> ModuleType:
    """It prints its build time while it is imported: only within silenced()."""
    try:
        import pybullet
    except ImportError:
        raise _missing_extra() from None
    return cast("ModuleType", pybullet)


def _missing_extra() -> MissingExtra:
    return MissingExtra(
        "the simulator needs pybullet and numpy",
        "type: pip install '.[sim]' in a checkout of lcmtools (there are wheels for Linux x86_64"
        " with Python 3.10 and 3.11)",
    )
