"""The engine: what collides, falls and is pushed. The only module that knows pybullet.

It builds the ground, boxes and robot bodies, steps them, and tells and sets their velocities.
What wheels and tyres do is not known here: a robot's body has no friction, drive.py pulls it.
"""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import NamedTuple, cast

from lcmtools.errors import MissingExtra
from lcmtools_sim.robots.model import Body, Mesh
from lcmtools_sim.rotation import Quaternion, Vector, from_euler
from lcmtools_sim.scene import Box, Color, Ground, Pose, Scene
from lcmtools_sim.silence import silenced


class Motion(NamedTuple):
    """How a body is and moves, in the world frame. A tuple, for it is made every step.

    Attributes:
        position: Of the centre of mass [m].
        rotation: Of the body.
        velocity: Of the centre of mass [m/s].
        turning: Angular velocity [rad/s].
    """

    position: Vector
    rotation: Quaternion
    velocity: Vector
    turning: Vector


class World:
    """One Bullet world, built from a scene's ground and boxes; robots are added to it.

    A context manager: it owns its connection to the engine.

    Args:
        scene: Step, gravity, ground and boxes.
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
            self._names: dict[int, str] = {}
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
            if self.is_open():
                self._bullet.disconnect(physicsClientId=self._client)

    def is_open(self) -> bool:
        """Whether the engine is there; a window that the user closed takes it away."""
        return bool(self._bullet.isConnected(physicsClientId=self._client))

    def step(self) -> None:
        """Let one dt pass."""
        self._bullet.stepSimulation(physicsClientId=self._client)

    def motion(self, body: int) -> Motion:
        """How a body is and moves now."""
        position, rotation = self._bullet.getBasePositionAndOrientation(body, self._client)
        velocity, turning = self._bullet.getBaseVelocity(body, self._client)
        return Motion(position, rotation, velocity, turning)

    def set_velocity(self, body: int, velocity: Vector, turning: Vector) -> None:
        """Give a body another velocity [m/s] and angular velocity [rad/s], in the world frame."""
        self._bullet.resetBaseVelocity(body, velocity, turning, self._client)

    def overlap(self, body: int) -> tuple[float, str]:
        """How deep a body stands in another one [m], and the other's name; (0, "") in none."""
        self._bullet.performCollisionDetection(physicsClientId=self._client)
        contacts = self._bullet.getContactPoints(body, physicsClientId=self._client)
        deepest = min(contacts, key=lambda contact: contact[8], default=None)
        if deepest is None or deepest[8] >= 0:
            return 0.0, ""
        return -deepest[8], self._names[deepest[2]]

    def add_box(self, box: Box) -> int:
        """Put up a box and return its body's number."""
        half = [side / 2 for side in box.size]
        shape = self._bullet.createCollisionShape(
            self._bullet.GEOM_BOX, halfExtents=half, physicsClientId=self._client
        )
        body = self._add_body(box.name, box.mass, shape, box.pose)
        self._set_surface(body, box.friction, box.color)
        return body

    def add_robot(self, name: str, body: Body, pose: Pose) -> int:
        """Put up a robot's body, ``pose`` being that of its base_footprint; return its number."""
        number = self._add_body(
            name,
            body.mass,
            self._collision_shape(body),
            pose,
            baseInertialFramePosition=(0.0, 0.0, body.centre_of_mass),
            **(self._looks(body) if self._window else {}),
        )
        if self._window:
            self._look_at(pose)
        self._bullet.changeDynamics(
            number,
            -1,
            lateralFriction=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            localInertiaDiagonal=body.inertia,
            physicsClientId=self._client,
        )
        return number

    def _build(self, scene: Scene) -> None:
        bullet, client = self._bullet, self._client
        bullet.setGravity(0.0, 0.0, -scene.gravity, physicsClientId=client)
        bullet.setTimeStep(scene.dt, physicsClientId=client)
        if self._window:
            bullet.configureDebugVisualizer(bullet.COV_ENABLE_GUI, 0, physicsClientId=client)
        self._add_ground(scene.ground)
        for box in scene.boxes:
            self.add_box(box)

    def _add_ground(self, ground: Ground) -> None:
        shape = self._bullet.createCollisionShape(
            self._bullet.GEOM_PLANE, physicsClientId=self._client
        )
        body = self._add_body("the ground", 0.0, shape, Pose())
        self._set_surface(body, ground.friction, ground.color)

    def _add_body(self, name: str, mass: float, shape: int, pose: Pose, **more: object) -> int:
        """Make a body; ``more`` are createMultiBody's own names."""
        number = self._bullet.createMultiBody(
            mass,
            shape,
            basePosition=(pose.x, pose.y, pose.z),
            baseOrientation=from_euler(pose.roll, pose.pitch, pose.yaw),
            physicsClientId=self._client,
            **more,
        )
        self._names[number] = name
        return int(number)

    def _set_surface(self, body: int, friction: float, color: Color) -> None:
        self._bullet.changeDynamics(
            body, -1, lateralFriction=friction, physicsClientId=self._client
        )
        self._bullet.changeVisualShape(
            body, -1, rgbaColor=(*color, 1.0), physicsClientId=self._client
        )

    def _collision_shape(self, body: Body) -> int:
        """The cuboids and the feet as one compound."""
        bullet, cuboids, radius = self._bullet, body.cuboids, body.foot_radius
        number = bullet.createCollisionShapeArray(
            shapeTypes=[bullet.GEOM_BOX] * len(cuboids) + [bullet.GEOM_SPHERE] * len(body.feet),
            halfExtents=[[side / 2 for side in part.size] for part in cuboids]
            + [[0.0, 0.0, 0.0]] * len(body.feet),
            radii=[0.0] * len(cuboids) + [radius] * len(body.feet),
            collisionFramePositions=[part.centre for part in cuboids]
            + [(x, y, radius) for x, y in body.feet],
            physicsClientId=self._client,
        )
        return int(number)

    def _looks(self, body: Body) -> dict[str, object]:
        """The first mesh as the body's look, the others as links without mass and collision.

        One body shows only one colour, and without a look it shows its collision shapes.
        """
        if not body.meshes:
            return {}
        bullet, (base, *links), count = self._bullet, body.meshes, len(body.meshes) - 1
        nowhere, unturned = [(0.0, 0.0, 0.0)] * count, [(0.0, 0.0, 0.0, 1.0)] * count
        return {
            "baseVisualShapeIndex": self._mesh_shape(base, base.position),
            "linkMasses": [0.0] * count,
            "linkCollisionShapeIndices": [-1] * count,
            "linkVisualShapeIndices": [self._mesh_shape(mesh) for mesh in links],
            "linkPositions": [mesh.position for mesh in links],
            "linkOrientations": [mesh.rotation for mesh in links],
            "linkInertialFramePositions": nowhere,
            "linkInertialFrameOrientations": unturned,
            "linkParentIndices": [0] * count,
            "linkJointTypes": [bullet.JOINT_FIXED] * count,
            "linkJointAxis": nowhere,
        }

    def _mesh_shape(self, mesh: Mesh, position: Vector = (0.0, 0.0, 0.0)) -> int:
        folder = import_module("pybullet_data").getDataPath()
        number = self._bullet.createVisualShape(
            self._bullet.GEOM_MESH,
            fileName=f"{folder}/{mesh.file}",
            rgbaColor=(*mesh.color, 1.0),
            visualFramePosition=position,
            physicsClientId=self._client,
        )
        return int(number)

    def _look_at(self, pose: Pose) -> None:
        """Point the window's camera at a place, from behind and above."""
        self._bullet.resetDebugVisualizerCamera(
            cameraDistance=4.0,
            cameraYaw=-60.0,
            cameraPitch=-30.0,
            cameraTargetPosition=(pose.x, pose.y, pose.z),
            physicsClientId=self._client,
        )


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
