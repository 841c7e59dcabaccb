"""The engine: collisions, gravity and pushing. The only module that knows pybullet.

It builds the ground, objects and robot bodies (by bodies.py), steps them, reads and sets their
motion, and lets sensors look at them. Wheels and tyres are not known here: a robot's body has no
friction, the tyres (tyres.py) pull it.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from importlib.util import find_spec
from types import ModuleType
from typing import NamedTuple, cast

from lcmtools.errors import MissingExtra
from lcmtools_sim.bodies import BodyFactory
from lcmtools_sim.geometry import ZERO, Pose, Quaternion, Vector
from lcmtools_sim.mesh_display import MeshDisplay, WheelAngles
from lcmtools_sim.native import suppressed_output
from lcmtools_sim.robots.model import Body
from lcmtools_sim.scene import Scene, SceneObject
from lcmtools_sim.sensors.sensor import Contact
from lcmtools_sim.shapes import Part

_RECOVERY = 12.0
"""[1/s] The rate at which bodies that overlap separate; a higher one shakes a pushed body aside."""


class Motion(NamedTuple):
    """The pose and velocity of a body in the world frame. A tuple, for it is made every step.

    Attributes:
        position: Of the centre of mass [m].
        rotation: Of the body.
        velocity: Of the centre of mass [m/s].
        angular_velocity: [rad/s]
    """

    position: Vector
    rotation: Quaternion
    velocity: Vector
    angular_velocity: Vector


class World(AbstractContextManager["World"]):
    """One Bullet world, built from a scene's ground and objects; robots are added to it.

    A context manager: it owns its connection to the engine. A ``window`` needs a display (see
    native.py: without one, Bullet ends the process).

    Raises:
        MissingExtra: pybullet is not installed.
    """

    def __init__(self, scene: Scene, *, window: bool = False) -> None:
        with suppressed_output():
            self._bullet = _import_pybullet()
            self._client: int = self._bullet.connect(
                self._bullet.GUI if window else self._bullet.DIRECT
            )
            self._window = window
            self._make = BodyFactory(self._bullet, self._client)
            self._build(scene)

    def __exit__(self, *_: object) -> None:
        """Disconnect from the engine."""
        self.close()

    def close(self) -> None:
        """Disconnect from the engine; the window closes."""
        with suppressed_output():
            if self._is_connected():
                self._bullet.disconnect(physicsClientId=self._client)

    def is_open(self) -> bool:
        """Return False once the user has closed the window, which takes the engine away."""
        return not self._window or self._is_connected()

    def step(self) -> None:
        """Simulate one dt."""
        self._bullet.stepSimulation(physicsClientId=self._client)
        if self._meshes:
            self._meshes.step()

    def motion(self, body: int) -> Motion:
        """The present pose and velocity of a body."""
        bullet, client = self._bullet, self._client
        place = bullet.getBasePositionAndOrientation(body, client)
        return Motion._make(place + bullet.getBaseVelocity(body, client))

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a body's velocity [m/s] and angular velocity [rad/s], in the world frame."""
        self._bullet.resetBaseVelocity(body, velocity, angular_velocity, self._client)

    def overlap(self, body: int) -> tuple[float, str]:
        """The deepest penetration of a body [m], and the other body's name; or (0, "")."""
        self._bullet.performCollisionDetection(physicsClientId=self._client)
        return self._deepest(body)

    def overlaps(self) -> list[tuple[SceneObject, float, str]]:
        """The same of every movable object that overlaps another body."""
        self._bullet.performCollisionDetection(physicsClientId=self._client)
        found = [(thing, *self._deepest(body)) for thing, body in self._objects if thing.mass]
        return [(thing, depth, other) for thing, depth, other in found if depth]

    def overlap_at(self, body: int, position: Vector, rotation: Quaternion) -> tuple[float, str]:
        """The ``overlap`` with the centre of mass at this pose; the body stays as it is."""
        now = self.motion(body)
        self.place(body, position, rotation)
        found = self.overlap(body)
        self.place(body, now.position, now.rotation)
        self.set_velocity(body, now.velocity, now.angular_velocity)
        return found

    def add(self, thing: SceneObject) -> int:
        """Add an object and return its body's number."""
        body = self._make.scene_object(thing)
        self._names[body] = thing.name
        if thing.mass:
            self._moving[body] = thing.parts
        else:
            self._fixed += tuple(part.placed(*thing.pose.frame) for part in thing.parts)
        return body

    def add_robot(
        self, name: str, body: Body, pose: Pose, angles: WheelAngles = lambda: (0.0, 0.0)
    ) -> int:
        """Add a robot's body, ``pose`` being that of its base_footprint; return its number.

        A window turns its wheels by ``angles``.
        """
        with self._without_rendering():
            number = self._make.robot(body, pose)
            self._names[number] = name
            height = body.centre_of_mass  # the engine's origin
            self._moving[number] = tuple(part.placed((0.0, 0.0, -height)) for part in body.parts)
            if self._meshes:
                self._meshes.add(number, body.meshes, height, angles)
                self._look_at(pose)
        return number

    def remove(self, body: int) -> None:
        """Remove a robot."""
        with self._without_rendering():
            if self._meshes:
                self._meshes.hide_all()
            self._bullet.removeBody(body, physicsClientId=self._client)
            del self._names[body], self._moving[body]
            if self._meshes:
                self._meshes.forget(body)
                self._meshes.show_all()

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a robot's centre of mass at a pose, at rest."""
        self._bullet.resetBasePositionAndOrientation(body, position, rotation, self._client)
        self.set_velocity(body, ZERO, ZERO)
        if self._meshes:
            self._meshes.show(body)

    def reset(self, scene: Scene) -> None:
        """Start again with the ground and the objects of a scene, without robots."""
        with suppressed_output():
            self._bullet.resetSimulation(physicsClientId=self._client)
            self._build(scene)

    def fixed_parts(self) -> tuple[Part, ...]:
        """The immovable shapes, in the world; the same object until one is added."""
        return self._fixed

    def moving_bodies(
        self, but: int | None = None
    ) -> list[tuple[tuple[Part, ...], Vector, Quaternion]]:
        """The movable bodies (but one): their shapes in a frame, and its pose."""
        place = self._bullet.getBasePositionAndOrientation
        return [
            (parts, *place(body, self._client))
            for body, parts in self._moving.items()
            if body != but
        ]

    def moving_parts(self, but: int | None = None) -> list[Part]:
        """The shapes of all movable bodies (but one), in the world."""
        bodies = self.moving_bodies(but)
        return [part.placed(place, turn) for parts, place, turn in bodies for part in parts]

    def contacts(self, body: int) -> list[Contact]:
        """The contacts of a body but for the ground, as of the last step."""
        points = self._bullet.getContactPoints(body, physicsClientId=self._client)
        return [
            Contact(self._names[point[2]], point[5], point[7], point[9], -point[8])
            for point in points
            if point[2] != self._ground and point[9] > 0
        ]

    def _deepest(self, body: int) -> tuple[float, str]:
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
            # By default, bodies that start on the ground fall into the engine's slop, and bounce.
            contactSlop=0.0,
            contactERP=_RECOVERY * scene.dt,
            # The engine's defaults are so coarse that crates at rest creep.
            solverResidualThreshold=1e-12,
            warmStartingFactor=1.0,
            physicsClientId=client,
        )
        if self._window:
            bullet.configureDebugVisualizer(bullet.COV_ENABLE_GUI, 0, physicsClientId=client)
        self._names: dict[int, str] = {}
        self._fixed: tuple[Part, ...] = ()
        self._moving: dict[int, tuple[Part, ...]] = {}
        """The shapes of movable bodies, in the frame of the engine's poses."""
        self._meshes = MeshDisplay(bullet, client, self._make.mesh) if self._window else None
        self._ground = self._make.ground(scene.ground)
        self._names[self._ground] = "the ground"
        with self._without_rendering():
            self._objects = [(thing, self.add(thing)) for thing in scene.objects]

    @contextmanager
    def _without_rendering(self) -> Iterator[None]:
        """Pause the window: it would draw everything for each body that is added or removed."""
        configure, flag = self._bullet.configureDebugVisualizer, self._bullet.COV_ENABLE_RENDERING
        configure(flag, 0, physicsClientId=self._client)
        try:
            yield
        finally:
            configure(flag, 1, physicsClientId=self._client)

    def _look_at(self, pose: Pose) -> None:
        """Point the window's camera at a place, from behind and above."""
        self._bullet.resetDebugVisualizerCamera(
            cameraDistance=4.0,
            cameraYaw=-60.0,
            cameraPitch=-30.0,
            cameraTargetPosition=pose.position,
            physicsClientId=self._client,
        )


def check_installed() -> None:
    """Return if the extra's packages are installed, without importing them.

    Raises:
        MissingExtra: One is not; the hint has the command to type.
    """
    if not (find_spec("pybullet") and find_spec("PIL")):
        raise _missing_extra()


def _import_pybullet() -> ModuleType:
    """Import it; it prints its build time."""
    try:
        import pybullet
    except ImportError:
        raise _missing_extra() from None
    return cast("ModuleType", pybullet)


def _missing_extra() -> MissingExtra:
    return MissingExtra(
        "the simulator needs pybullet, numpy and pillow",
        "type: pip install '.[sim]' in a checkout of lcmtools (there are wheels for Linux x86_64"
        " with Python 3.10 and 3.11)",
    )
