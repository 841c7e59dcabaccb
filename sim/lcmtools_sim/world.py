"""The world: the ground, objects and robots' bodies, simulated by an engine.

It steps them, reads and sets their motion, and lets sensors see them. Wheels and tyres are not
known here: a robot's body has no friction, the tyres (tyres.py) pull it.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from itertools import chain, count

from lcmtools.errors import UsageError
from lcmtools_sim.engines import chosen_engine, start_engine
from lcmtools_sim.engines.engine import Motion, RigidBody
from lcmtools_sim.geometry import Frame, Pose, Quaternion, Vector
from lcmtools_sim.robots.model import BLACK, Body
from lcmtools_sim.scene import Scene, SceneObject
from lcmtools_sim.sensors.sensor import Contact
from lcmtools_sim.shapes import Part, Sphere, centre_of_mass, inertials_of, moments
from lcmtools_sim.vision.solids import PlacedSolids, Solids, solids_of

START_OVERLAP = 0.02  # [m] largest allowed penetration of another body at the start
_AT_REST = 1e-6  # [m/s, rad/s] bodies that are slower at two successive updates are left at rest


class World(AbstractContextManager["World"]):
    """A scene's ground and objects in an engine; robots are added to it.

    A context manager: it owns the engine's world. ``engine`` is one of ENGINES or "" (see
    engines.chosen_engine); MissingExtra without it.
    """

    def __init__(self, scene: Scene, *, engine: str = "") -> None:
        self._engine = start_engine(chosen_engine(engine))
        self._rests = self._rested = False
        """True if everything in the engine was at rest at the last two updates; at the last one."""
        self.reset(scene)

    def __exit__(self, *_: object) -> None:
        """Free the engine's world."""
        self.close()

    def close(self) -> None:
        """Free the engine's world."""
        self._engine.close()

    def warnings(self) -> list[str]:
        """Return the engine's warnings since the last call, only the first of each kind."""
        return self._engine.warnings()

    def step(self) -> None:
        """Simulate one dt of all bodies in the engine; those at rest stay so."""
        if not self._rests:
            self._engine.step()
        self._bodies.clear()

    def find_rest(self) -> None:
        """Check whether all movable bodies in the engine are at rest, for the next steps."""
        bodies = self._moving.keys() - self._released.keys()
        speeds = [speed for body in bodies for speed in self._engine.motion(body)[2:]]
        at_rest = all(abs(value) < _AT_REST for speed in speeds for value in speed)
        self._rests = at_rest and self._rested
        self._rested = at_rest

    def motion(self, body: int) -> Motion:
        """Return the current pose and velocity of a body."""
        released = self._released.get(body)
        return released() if released else self._engine.motion(body)

    def motions(self, bodies: Sequence[int]) -> Motion:
        """Return the current motions of several bodies in the engine, as arrays."""
        return self._engine.motions(bodies)

    def release(self, body: int, motion: Callable[[], Motion]) -> None:
        """Take a body that touches only the ground out of the engine; it moves by ``motion``."""
        self._released[body] = motion
        self._bodies.clear()
        self._engine.disable(body)

    def hold(self, body: int, motion: Motion) -> None:
        """Put a released body back into the engine, with this motion."""
        del self._released[body]
        self._engine.enable(body)
        self._engine.place(body, motion.position, motion.rotation)
        self.set_velocity(body, motion.velocity, motion.angular_velocity)

    def movable_objects(self) -> list[tuple[SceneObject, int]]:
        """Return each movable object and its body, whose motion is the object's frame's."""
        return [(thing, body) for thing, body in self._objects if thing.mass]

    def name(self, body: int) -> str:
        """Return a body's name; if movable ones share a name, later ones get numbers (crate_2)."""
        return self._names[body]

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a body's velocity [m/s] and angular velocity [rad/s], in the world frame."""
        self._engine.set_velocity(body, velocity, angular_velocity)
        self._wake()

    def set_velocities(
        self, bodies: Sequence[int], velocities: Vector, angular_velocities: Vector
    ) -> None:
        """Do the same for several bodies, given as arrays."""
        self._engine.set_velocities(bodies, velocities, angular_velocities)
        self._wake()

    def detect_contacts(self) -> None:
        """Find the contacts at the current poses, for ``overlap`` and ``overlaps``."""
        self._engine.detect_contacts()

    def overlap(self, body: int) -> tuple[float, str]:
        """Return the deepest penetration of a body [m], and the other body's name, or (0, "")."""
        points = self._engine.contacts(body)
        deepest = max(points, key=lambda point: point.depth, default=None)
        if deepest is None or deepest.depth <= 0:
            return 0.0, ""
        return deepest.depth, self._names[deepest.other]

    def overlaps(self) -> list[tuple[SceneObject, float, str]]:
        """Return the same for every movable object that overlaps another body."""
        found = [(thing, *self.overlap(body)) for thing, body in self._objects if thing.mass]
        return [(thing, depth, other) for thing, depth, other in found if depth]

    def add(self, thing: SceneObject) -> int:
        """Add an object, whose origin is its centre of mass; return its body's number."""
        inertials = inertials_of(thing.parts, thing.mass)
        inertia, frame = moments(inertials, centre_of_mass(inertials)[1]), thing.pose.frame
        rigid = RigidBody(thing.parts, *frame, thing.mass, inertia, thing.friction)
        body = self._engine.add(rigid)
        self._names[body] = self._free_name(thing.name) if thing.mass else thing.name
        self._wake()
        if thing.mass:
            self._moving[body] = thing.parts
        else:
            self._fixed += tuple(part.placed(*frame) for part in thing.parts)
        return body

    def add_robot(self, name: str, body: Body, pose: Pose) -> int:
        """Add a robot's body, with its base_footprint at ``pose``; return its number."""
        height, radius = body.centre_of_mass, body.foot_radius
        parts = tuple(part.placed((0.0, 0.0, -height)) for part in body.parts)
        feet = [Part(Sphere(radius), (x, y, radius - height), color=BLACK) for x, y in body.feet]
        place = pose.frame.point((0.0, 0.0, height)), pose.rotation
        rigid = RigidBody([*parts, *feet], *place, body.mass, body.inertia, is_robot=True)
        number = self._engine.add(rigid)
        self._names[number], self._moving[number] = name, parts
        self._bodies.clear()
        return number

    def remove(self, body: int) -> None:
        """Remove a robot."""
        self._engine.remove(body)
        self._wake()
        del self._names[body], self._moving[body]
        self._released.pop(body, None)
        self._solids.pop(body, None)

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a body's centre of mass at a pose, at rest. The engine must know all bodies' poses.

        Raises:
            UsageError: It would be inside another body; it is not moved.
        """
        now = self.motion(body)
        self._engine.place(body, position, rotation)
        self._wake()
        self.detect_contacts()
        depth, other = self.overlap(body)
        if depth > START_OVERLAP:
            self._engine.place(body, now.position, now.rotation)
            self.set_velocity(body, now.velocity, now.angular_velocity)
            what = f"{self._names[body]} would be {depth:.2f} m inside {other}"
            raise UsageError(what, "choose another place")

    def reset(self, scene: Scene) -> None:
        """Start again with the ground and the objects of a scene, without robots."""
        self._engine.begin(scene)
        self._names = {self._engine.ground: "the ground"}
        self._fixed: tuple[Part, ...] = ()
        self._fixed_solids: tuple[tuple[Part, ...], Solids] = (), solids_of(())
        self._moving: dict[int, tuple[Part, ...]] = {}
        """The shapes of movable bodies, in the frame of the engine's poses."""
        self._solids: dict[int, Solids] = {}  # the same, as arrays
        self._bodies: dict[int, PlacedSolids] = {}
        """The last result of ``moving_bodies``; empty if something has moved since."""
        self._released: dict[int, Callable[[], Motion]] = {}
        """The motions of bodies that the engine does not move."""
        self._wake()
        self._objects = [(thing, self.add(thing)) for thing in scene.objects]

    def fixed_parts(self) -> tuple[Part, ...]:
        """The immovable shapes, in the world; the same object until one is added."""
        return self._fixed

    def fixed_solids(self) -> Solids:
        """The immovable shapes as arrays; the same object until one is added."""
        if self._fixed_solids[0] is not self._fixed:
            self._fixed_solids = self._fixed, solids_of(self._fixed)
        return self._fixed_solids[1]

    def moving_bodies(self) -> Mapping[int, PlacedSolids]:
        """Return the movable bodies by their numbers."""
        if not self._bodies:
            solids, motion = self._solids, self.motion
            for body in self._moving.keys() - solids.keys():
                solids[body] = solids_of(self._moving[body])
            self._bodies = {body: (solids[body], *motion(body)[:2]) for body in self._moving}
        return self._bodies

    def moving_parts(self, but: int | None = None) -> list[Part]:
        """Return the shapes of all movable bodies except ``but``, in the world."""
        poses = {body: self.motion(body)[:2] for body in self._moving if body != but}
        return [part.placed(*pose) for body, pose in poses.items() for part in self._moving[body]]

    def contacts(self, body: int) -> list[Contact]:
        """Return the contacts of a body, except with the ground, after the last step."""
        if body in self._released:
            return []
        return [
            Contact(self._names[point.other], *point[1:])
            for point in self._engine.contacts(body)
            if point.other != self._engine.ground and point.force > 0
        ]

    def _free_name(self, name: str) -> str:
        taken = {self._names[body] for body in self._moving}
        names = chain((name,), (f"{name}_{number}" for number in count(2)))
        return next(one for one in names if one not in taken)

    def _wake(self) -> None:
        """Let the engine simulate again what was at rest."""
        self._rests = self._rested = False
        self._bodies.clear()


class MovableObject:
    """An object of a world; its frame is on the ground below its centre, like a robot's."""

    def __init__(self, world: World, thing: SceneObject, body: int) -> None:
        self.name = world.name(body)  # unique among the world's movable objects
        self._world, self._body = world, body
        self._height = max(part.extent(2) - part.position[2] for part in thing.parts)
        lift = 0.0, 0.0, self._height
        self.parts = tuple(part.placed(lift) for part in thing.parts)  # its shapes, in its frame

    @property
    def frame(self) -> Frame:
        """Its frame in the world."""
        position, rotation = self._world.motion(self._body)[:2]
        return Frame(Frame(position, rotation).point((0.0, 0.0, -self._height)), rotation)

    def place(self, pose: Pose) -> None:
        """Put its frame at a pose, at rest; see ``World.place``."""
        centre = pose.frame.point((0.0, 0.0, self._height))
        self._world.place(self._body, centre, pose.rotation)
