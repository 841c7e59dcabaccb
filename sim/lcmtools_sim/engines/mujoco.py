"""MuJoCo, through its own Python package.

Its contacts are soft and convex: the settings here keep contacts as hard, and sliding bodies as
low, as textbook rigid bodies. A step calls the stages of mj_step one by one, because friction is
set between collisions and constraints. Stages and fields have MuJoCo's names (its "Computation").
"""

import math
import re
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from lcmtools_sim.engines.engine import ContactPoint, Motion, RigidBody
from lcmtools_sim.geometry import ZERO, Quaternion, Vector, axes, components, rotate
from lcmtools_sim.scene import Scene
from lcmtools_sim.shapes import Cuboid, Cylinder, Shape, Sphere

_IMPEDANCE = (0.99, 0.999)
"""The share of a contact's acceleration set by the constraint, at the surface and below it."""
_STEPS = 2  # time constant of contacts, in steps. MuJoCo allows no less than 2.
_DAMPING = 2.0  # ratio, of contacts: bodies separate at 6 % of their speed; with 1, at 16 %
_BRAKING = 20.0  # [m/s^2] the most that friction's reference demands: see _set_friction
_LEAST_FRICTION = 1e-5  # as mjMINMU: MuJoCo allows no less
_LEAST_MASS = 1e-14  # [kg, kg m^2] above mjMINVAL, likewise
_ROUGH, _SMOOTH = 3, 1
"""condim: contacts with friction, and without; the higher value of two shapes applies."""
_CONTACTS: dict[type[Shape], int] = {Cuboid: 4, Cylinder: 2, Sphere: 1}
"""The number of points on which an object of one shape rests."""
_FEET = 4  # the same for a robot

_Array = npt.NDArray[np.float64]
_Places = npt.NDArray[np.intp]


class Mujoco:
    """A MuJoCo world (see engine.Engine).

    Added and removed bodies are compiled when the model is next used: once for a whole fleet.
    """

    ground = 0

    def __init__(self) -> None:
        self._warnings: list[str] = []
        self._warned: set[str] = set()
        # By default, it writes a warning into a file in the working directory.
        mujoco.set_mju_user_warning(self._warnings.append)

    def begin(self, scene: Scene) -> None:
        """Empty the world, and set a scene's gravity, dt and ground."""
        self._dt = scene.dt
        spec = self._spec = mujoco.MjSpec()
        option, geom = spec.option, spec.default.geom
        option.timestep, option.gravity = scene.dt, [0.0, 0.0, -scene.gravity]
        option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10
        option.tolerance = 1e-10
        # A URDF file may have moments of inertia that no body has: MuJoCo takes their mean.
        spec.compiler.balanceinertia = True
        spec.compiler.boundmass = spec.compiler.boundinertia = _LEAST_MASS
        geom.solref = [_STEPS * scene.dt, _DAMPING]
        geom.solimp = [*_IMPEDANCE, 0.0005, 0.5, 2.0]
        # A body on one contact rests at this depth (d, dmax and k in MuJoCo's "Solver parameters").
        # With it as margin, the contact carries the weight at depth 0: bodies start at rest.
        low, high = _IMPEDANCE
        self._rest = (1 - low) / low * scene.gravity * (high * _STEPS * scene.dt * _DAMPING) ** 2
        kind = mujoco.mjtGeom.mjGEOM_PLANE
        friction = [scene.ground.friction, 0.0, 0.0]
        spec.worldbody.add_geom(type=kind, size=[0, 0, 1], friction=friction, condim=_SMOOTH)
        self._bodies: dict[int, RigidBody] = {}
        self._disabled: set[int] = set()
        self._handles: dict[int, Any] = {}
        self._free: dict[int, tuple[slice, slice]] = {}
        """The ranges of compiled bodies' poses and velocities in qpos and qvel."""
        self._last = self.ground
        self._model: Any = None
        self._is_compiled = False

    def add(self, body: RigidBody) -> int:
        """Add a body and return its number."""
        self._last += 1
        world, name = self._spec.worldbody, str(self._last)
        handle = world.add_body(name=name, pos=body.position, quat=_wxyz(body.rotation))
        if body.mass:
            handle.add_freejoint()
            handle.explicitinertial = True
            handle.mass, handle.inertia = body.mass, body.inertia
            handle.ipos, handle.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
        is_object = body.mass and not body.is_robot
        for part in body.parts:
            kind, size = _geom(part.shape)
            points = _CONTACTS[type(part.shape)] if is_object else _FEET
            handle.add_geom(
                type=kind,
                size=size,
                pos=part.position,
                quat=_wxyz(part.rotation),
                friction=[body.friction, 0.0, 0.0],
                condim=_ROUGH if is_object else _SMOOTH,
                margin=self._rest / points if body.mass else 0.0,
            )
        self._bodies[self._last], self._handles[self._last] = body, handle
        self._is_compiled = False
        return self._last

    def remove(self, body: int) -> None:
        """Remove a body."""
        self._compile()
        self._spec.delete(self._handles.pop(body))
        del self._bodies[body], self._free[body]
        self._disabled.discard(body)
        self._is_compiled = False

    def disable(self, body: int) -> None:
        """Exclude a movable body from the simulation."""
        self._compile()
        self._disabled.add(body)
        self._set_enabled(body, is_enabled=False)

    def enable(self, body: int) -> None:
        """Undo ``disable``."""
        self._compile()
        self._disabled.discard(body)
        self._set_enabled(body, is_enabled=True)

    def step(self) -> None:
        """Simulate one dt."""
        self._compile()
        self._stop_at_walls()
        self._constrain()
        model, data = self._model, self._data
        mujoco.mj_island(model, data)
        mujoco.mj_projectConstraint(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        mujoco.mj_fwdConstraint(model, data)
        mujoco.mj_Euler(model, data)

    def motion(self, body: int) -> Motion:
        """Return the current motion of a body."""
        if body not in self._free:  # not compiled yet, or immovable
            return Motion(self._bodies[body].position, self._bodies[body].rotation)
        pose, velocity = self._free[body]
        x, y, z, qw, qx, qy, qz = self._qpos[pose].tolist()
        vx, vy, vz, wx, wy, wz = self._qvel[velocity].tolist()
        rotation = (qx, qy, qz, qw)
        return Motion((x, y, z), rotation, (vx, vy, vz), rotate((wx, wy, wz), rotation))

    def motions(self, bodies: Sequence[int]) -> Motion:
        """Return the current motions of movable bodies, as arrays."""
        self._compile()
        poses, velocities = self._addresses_of(bodies)
        x, y, z, qw, qx, qy, qz = self._qpos[poses]
        vx, vy, vz, *turning = self._qvel[velocities]
        rotation = (qx, qy, qz, qw)
        return Motion((x, y, z), rotation, (vx, vy, vz), rotate((*turning,), rotation))

    def place(self, body: int, position: Vector, rotation: Quaternion) -> None:
        """Put a movable body's centre of mass at a pose, at rest."""
        self._compile()
        self._qpos[self._free[body][0]] = (*position, *_wxyz(rotation))
        self.set_velocity(body, ZERO, ZERO)

    def set_velocity(self, body: int, velocity: Vector, angular_velocity: Vector) -> None:
        """Set a movable body's velocity [m/s] and angular velocity [rad/s], in the world frame."""
        self._compile()
        pose, place = self._free[body]
        qw, qx, qy, qz = self._qpos[pose.start + 3 : pose.stop].tolist()
        own = components(angular_velocity, axes((qx, qy, qz, qw)))
        self._qvel[place] = (*velocity, *own)

    def set_velocities(
        self, bodies: Sequence[int], velocities: Vector, angular_velocities: Vector
    ) -> None:
        """Do the same for several bodies, given as arrays."""
        self._compile()
        poses, places = self._addresses_of(bodies)
        qw, qx, qy, qz = self._qpos[poses[3:]]
        self._qvel[places] = (*velocities, *components(angular_velocities, axes((qx, qy, qz, qw))))

    def detect_contacts(self) -> None:
        """Find the contacts at the current poses, without a step."""
        self._compile()
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeM(model, data)
        mujoco.mj_factorM(model, data)
        mujoco.mj_collision(model, data)
        if self._grows():
            self.detect_contacts()

    def contacts(self, body: int) -> list[ContactPoint]:
        """Return a body's contacts from the last step or ``detect_contacts``."""
        contact, own = self._data.contact, self._model.body(str(body)).id
        bodies = self._model.geom_bodyid
        first, second = bodies[contact.geom1], bodies[contact.geom2]
        found, force = [], np.zeros(6)
        for i in np.flatnonzero((first == own) | (second == own)).tolist():
            is_first = first[i] == own
            mujoco.mj_contactForce(self._model, self._data, i, force)
            other = self._number[second[i] if is_first else first[i]]
            place = _vector(contact.pos[i])
            normal = _vector(contact.frame[i, :3] * (-1.0 if is_first else 1.0))
            depth = -float(contact.dist[i])
            found.append(ContactPoint(other, place, normal, float(force[0]), depth))
        return found

    def warnings(self) -> list[str]:
        """Return the engine's warnings since the last call, only the first of each kind.

        Warnings about memory are left out, because it grows.
        """
        kinds = {re.sub(r"\d[\d.e+-]*", "", text): text for text in reversed(self._warnings)}
        new = {kind: text for kind, text in kinds.items() if kind not in self._warned}
        self._warnings.clear()
        self._warned |= new.keys()
        return [f"MuJoCo: {text.strip()}" for text in new.values() if "arena" not in text]

    def close(self) -> None:
        """Do nothing: there is only memory, which Python frees."""

    def _compile(self) -> None:
        """Update the model, and keep the motion of all bodies."""
        if self._is_compiled:
            return
        if self._model is None:
            self._model = self._spec.compile()
            self._data = mujoco.MjData(self._model)
        else:
            self._model, self._data = self._spec.recompile(self._model, self._data)
        model = self._model
        # It scales the solver's tolerance: a robot's motion must not depend on other bodies.
        model.stat.meaninertia = 1.0
        self._qpos, self._qvel = self._data.qpos, self._data.qvel
        found, kinds = self._data.warning, mujoco.mjtWarning
        self._full = found[kinds.mjWARN_CONTACTFULL], found[kinds.mjWARN_CNSTRFULL]
        self._number = [0, *(int(model.body(i).name) for i in range(1, model.nbody))]
        self._free = {}
        self._addresses: dict[tuple[int, ...], tuple[_Places, _Places]] = {}
        for i, number in enumerate(self._number):
            if model.body_dofnum[i]:
                velocity = int(model.body_dofadr[i])
                pose = int(model.jnt_qposadr[model.body_jntadr[i]])
                self._free[number] = slice(pose, pose + 7), slice(velocity, velocity + 6)
        adr = np.where(model.body_dofnum > 0, model.body_dofadr, model.nv)[model.geom_bodyid]
        self._speeds = adr[:, None] + np.arange(3)
        """The indices of each shape's velocity in qvel with three zeros appended."""
        self._friction = model.geom_friction[:, 0].copy()
        self._pairs: bytes | None = None  # the shapes of each contact of the last step
        self._objects = [
            (number, min(min(part.shape.size) for part in body.parts) / 2)
            for number, body in self._bodies.items()
            if body.mass and not body.is_robot
        ]
        self._is_compiled = True
        for number in self._disabled:
            self._set_enabled(number, is_enabled=False)

    def _constrain(self) -> None:
        self.detect_contacts()
        self._set_friction()
        mujoco.mj_makeConstraint(self._model, self._data)
        if self._grows():
            self._constrain()

    def _grows(self) -> bool:
        """Double the memory for contacts if more than half of it is used; return whether it did.

        MuJoCo's own size depends on the number of bodies: too small for many shapes.
        """
        size = self._model.narena
        if self._data.maxuse_arena <= size // 2 and not any(full.number for full in self._full):
            return False
        self._spec.memory = 2 * size
        self._is_compiled = False
        self._compile()
        return True

    def _addresses_of(self, bodies: Sequence[int]) -> tuple[_Places, _Places]:
        """Return indices of movable bodies' poses (7, n) and velocities (6, n) in qpos and qvel."""
        key = tuple(bodies)
        if key not in self._addresses:
            poses, velocities = zip(*(self._free[body] for body in key), strict=True)
            self._addresses[key] = (
                np.array([place.start for place in poses]) + np.arange(7)[:, None],
                np.array([place.start for place in velocities]) + np.arange(6)[:, None],
            )
        return self._addresses[key]

    def _set_enabled(self, body: int, *, is_enabled: bool) -> None:
        """Let a body collide and fall, or not collide and float."""
        model, number = self._model, self._model.body(str(body)).id
        first = int(model.body_geomadr[number])
        shapes = slice(first, first + int(model.body_geomnum[number]))
        model.geom_contype[shapes] = model.geom_conaffinity[shapes] = is_enabled
        lift = 0.0 if is_enabled else -model.opt.gravity[2] * self._bodies[body].mass
        self._data.xfrc_applied[number, 2] = lift
        self._qvel[self._free[body][1]] = 0.0

    def _set_friction(self) -> None:
        """Give each contact the product of its shapes' friction.

        A convex contact (Anitescu 2006) lifts a sliding body, by about friction x speed x the time
        in which it should stop. So this time is short where a body sticks and grows with its speed,
        so that the reference never demands more than _BRAKING. The speed of the centres stands for
        that of the contact: for rolling bodies this does no harm.
        """
        if not self._objects:
            return
        contact, speeds = self._data.contact, np.concatenate((self._qvel, (0.0, 0.0, 0.0)))
        if (pairs := contact.geom.tobytes()) != self._pairs:  # mostly they are unchanged
            self._pairs, self._rough = pairs, np.flatnonzero(contact.dim == _ROUGH)
            first, second = contact.geom[self._rough].T
            friction = self._friction[first] * self._friction[second]
            self._products = np.maximum(friction, _LEAST_FRICTION)[:, None]
            self._places = self._speeds[first], self._speeds[second]
        contact.friction[self._rough, :2] = self._products
        slip = speeds[self._places[0]] - speeds[self._places[1]]
        time = 2 / _BRAKING * np.sqrt(np.einsum("ni,ni->n", slip, slip))
        is_slow = time > _STEPS * self._dt
        if is_slow.any():
            reference = contact.solreffriction
            reference[self._rough[is_slow], 0] = time[is_slow]
            reference[self._rough[is_slow], 1] = 1.0

    def _stop_at_walls(self) -> None:
        """Put an object that would pass through something in this step before it, without a bounce.

        MuJoCo looks only at poses, and would find it first before a wall and then behind it.
        """
        for number, radius in self._objects:
            pose, velocity = self._free[number]
            speed = self._qvel[velocity.start : velocity.start + 3]
            path = math.hypot(*speed.tolist()) * self._dt
            if path < radius:
                continue
            centre, ahead = self._qpos[pose.start : pose.start + 3], speed * (self._dt / path)
            mujoco.mj_kinematics(self._model, self._data)
            own, normal = self._model.body(str(number)).id, np.zeros((3, 1))
            distance = mujoco.mj_ray(
                self._model, self._data, centre, ahead, None, 1, own, np.zeros(1, np.int32), normal
            )
            if 0 <= distance < path + radius:
                centre += ahead * max(0.0, distance - 1.01 * radius)
                speed -= normal[:, 0] * min(0.0, float(speed @ normal[:, 0]))


def _geom(shape: Shape) -> tuple[Any, Sequence[float]]:
    """Return a shape's kind and size, in MuJoCo's terms."""
    kinds = mujoco.mjtGeom
    if isinstance(shape, Cuboid):
        return kinds.mjGEOM_BOX, [side / 2 for side in shape.size]
    if isinstance(shape, Cylinder):
        return kinds.mjGEOM_CYLINDER, [shape.radius, shape.length / 2, 0.0]
    return kinds.mjGEOM_SPHERE, [shape.radius, 0.0, 0.0]


def _wxyz(rotation: Quaternion) -> Quaternion:
    """Return a quaternion in MuJoCo's order."""
    x, y, z, w = rotation
    return w, x, y, z


def _vector(array: _Array) -> Vector:
    x, y, z = array.tolist()
    return x, y, z
