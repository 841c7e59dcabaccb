"""One run of the simulator, from joining the bus to leaving it."""

import os
from collections.abc import Sequence

import lcmtools
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.display import check_display
from lcmtools_sim.loop import run
from lcmtools_sim.options import Options
from lcmtools_sim.scene import Scene, contents
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.world import check_installed


def simulate(scene: Scene, options: Options, arguments: Sequence[str]) -> None:
    """Simulate a scene on the bus until asked to end, or until the time given is over.

    Args:
        scene: What to simulate.
        options: Rate, duration and window.
        arguments: The whole command line, for the node's name, remaps and the bus.

    Raises:
        MissingExtra: pybullet is not installed.
        LcmtoolsError: There is no bus, or no display for the window.
    """
    check_installed()
    if options.gui:
        check_display(os.environ)
    lcmtools.init(arguments)  # before the engine: from here on Ctrl-C ends it quietly
    try:
        with Simulation(scene, window=options.gui) as simulation:
            _run(simulation, options)
    finally:
        lcmtools.shutdown()


def _run(simulation: Simulation, options: Options) -> None:
    scene = simulation.scene
    with lcmtools.Node(scene.node) as node:
        bridge = Bridge(node, simulation)
        node.get_logger().info(f"simulating {scene.name}: {contents(scene)}")
        pacer = Pacer(scene.dt / options.rate if options.rate else 0.0)
        steps = round(options.duration / scene.dt) if options.duration else None
        run(simulation, bridge, pacer, go_on=lcmtools.ok, steps=steps)
