"""The objects of a running simulation that can be pushed and moved elsewhere."""

from lcmtools_sim.geometry import Frame, Pose
from lcmtools_sim.scene import SceneObject
from lcmtools_sim.shapes import Part
from lcmtools_sim.world import World


class MovableObject:
    """An object of a world; its frame is on the ground below its centre, like a robot's."""

    def __init__(self, world: World, thing: SceneObject, body: int) -> None:
        self.name = world.name(body)  # unique among the world's movable objects
        self._world, self._body = world, body
        self._height = max(part.extent(2) - part.position[2] for part in thing.parts)
        # Its shapes, in its frame.
        self.parts: tuple[Part, ...] = tuple(
            part.placed((0.0, 0.0, self._height)) for part in thing.parts
        )

    @property
    def frame(self) -> Frame:
        """Its frame in the world."""
        position, rotation = self._world.motion(self._body)[:2]
        return Frame(Frame(position, rotation).point((0.0, 0.0, -self._height)), rotation)

    def place(self, pose: Pose) -> None:
        """Put its frame at a pose, at rest. The engine must know where all bodies are.

        Raises:
            UsageError: It would be inside another body; it is not moved.
        """
        centre = pose.frame.point((0.0, 0.0, self._height))
        self._world.place(self._body, centre, pose.rotation)
