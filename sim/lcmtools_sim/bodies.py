"""Making Bullet's bodies from things and robot models, and how they look.

The engine comes in as an argument: only world.py imports it.
"""

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

from lcmtools_sim.pose import Pose
from lcmtools_sim.robots.model import Body, Mesh
from lcmtools_sim.rotation import Vector, from_euler
from lcmtools_sim.scene import Ground, Thing
from lcmtools_sim.shapes import Color, Cuboid, Cylinder, Part, Shape, Sphere

_FEET_COLOR: Color = (0.2, 0.2, 0.2)


class BodyMaker:
    """Puts bodies into one world of the engine; each method returns the new body's number.

    Args:
        bullet: The engine.
        client: Its connection.
        has_window: Whether robots are to look like their meshes.
    """

    def __init__(self, bullet: ModuleType, client: int, *, has_window: bool) -> None:
        self._bullet = bullet
        self._client = client
        self._has_window = has_window

    def ground(self, ground: Ground) -> int:
        """The plane z = 0."""
        shape = self._bullet.createCollisionShape(
            self._bullet.GEOM_PLANE, physicsClientId=self._client
        )
        body = self._body(0.0, shape, Pose())
        self._set_surface(body, ground.friction, ground.color)
        return body

    def thing(self, thing: Thing) -> int:
        """A thing as one rigid body."""
        body = self._body(thing.mass, self._compound(thing.parts), thing.pose)
        self._set_surface(body, thing.friction, thing.parts[0].color)
        return body

    def robot(self, body: Body, pose: Pose) -> int:
        """A robot's body, ``pose`` being that of its base_footprint."""
        feet = [
            Part(Sphere(body.foot_radius), (x, y, body.foot_radius), color=_FEET_COLOR)
            for x, y in body.feet
        ]
        number = self._body(
            body.mass,
            self._compound([*body.parts, *feet]),
            pose,
            baseInertialFramePosition=(0.0, 0.0, body.centre_of_mass),
            **(self._looks(body) if self._has_window else {}),
        )
        self._bullet.changeDynamics(
            number,
            -1,
            lateralFriction=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            localInertiaDiagonal=body.inertia,
            physicsClientId=self._client,
        )
        if not (self._has_window and body.meshes):
            self._paint(number, body.parts[0].color)
        return number

    def wheels(self, body: Body) -> list[tuple[int, Mesh]]:
        """What is seen of a robot's wheels in a window, each a body that nothing touches."""
        meshes = [mesh for mesh in body.meshes if mesh.is_wheel]
        untouched = -1
        return [
            (self._body(0.0, untouched, Pose(), baseVisualShapeIndex=self._mesh_shape(mesh)), mesh)
            for mesh in meshes
        ]

    def _body(self, mass: float, shape: int, pose: Pose, **more: object) -> int:
        """Make a body; ``more`` are createMultiBody's own names."""
        number = self._bullet.createMultiBody(
            mass,
            shape,
            basePosition=pose.position,
            baseOrientation=from_euler(pose.roll, pose.pitch, pose.yaw),
            physicsClientId=self._client,
            **more,
        )
        return int(number)

    def _set_surface(self, body: int, friction: float, color: Color) -> None:
        self._bullet.changeDynamics(
            body, -1, lateralFriction=friction, physicsClientId=self._client
        )
        self._paint(body, color)

    def _paint(self, body: int, color: Color) -> None:
        """Give a body its colour: one body shows only one."""
        self._bullet.changeVisualShape(
            body, -1, rgbaColor=(*color, 1.0), physicsClientId=self._client
        )

    def _compound(self, parts: Sequence[Part]) -> int:
        """The collision shape of several parts, in one frame."""
        shapes = [part.shape for part in parts]
        number = self._bullet.createCollisionShapeArray(
            shapeTypes=[self._kind(shape) for shape in shapes],
            halfExtents=[_half_extents(shape) for shape in shapes],
            radii=[0.0 if isinstance(shape, Cuboid) else shape.radius for shape in shapes],
            lengths=[shape.length if isinstance(shape, Cylinder) else 0.0 for shape in shapes],
            collisionFramePositions=[part.position for part in parts],
            collisionFrameOrientations=[part.rotation for part in parts],
            physicsClientId=self._client,
        )
        return int(number)

    def _kind(self, shape: Shape) -> int:
        if isinstance(shape, Cuboid):
            return int(self._bullet.GEOM_BOX)
        if isinstance(shape, Cylinder):
            return int(self._bullet.GEOM_CYLINDER)
        return int(self._bullet.GEOM_SPHERE)

    def _looks(self, body: Body) -> dict[str, object]:
        """The first mesh as the body's look, the others as links without mass and collision.

        One body shows only one colour, and without a look it shows its collision shapes.
        """
        if not body.meshes:
            return {}
        bullet, (base, *links) = self._bullet, [one for one in body.meshes if not one.is_wheel]
        count = len(links)
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


def _half_extents(shape: Shape) -> Vector:
    if not isinstance(shape, Cuboid):
        return 0.0, 0.0, 0.0
    length, width, height = shape.size
    return length / 2, width / 2, height / 2
