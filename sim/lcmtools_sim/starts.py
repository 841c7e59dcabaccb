"""Whether everything in a scene can start where it is put: nothing deep inside something else.

The engine is asked, in a world that is given up at once; the running one never knows of it.
"""

from lcmtools_sim.robot import START_OVERLAP
from lcmtools_sim.scene import Scene
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import World


def check_starts(scene: Scene) -> None:
    """Return if every robot can start.

    Raises:
        InvalidFile: One stands inside something; with its file and line.
        MissingExtra: pybullet is not installed.
    """
    with Simulation(scene):
        pass


def misplaced_things(scene: Scene) -> list[str]:
    """What to say of things that can move and start inside something, one line each.

    Raises:
        MissingExtra: pybullet is not installed.
    """
    if not any(thing.mass for thing in scene.things):
        return []
    with World(scene) as world:
        found = world.overlaps()
    return [
        f"{thing.where or scene.name}: {thing.name} starts {depth:.2f} m inside {other}, and is"
        " thrown out of it"
        for thing, depth, other in found
        if depth > START_OVERLAP
    ]
