"""One run of the simulator, from joining the bus to leaving it."""

import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial

import lcmtools
from lcmtools.arguments import NodeArguments, split_arguments
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.types.geometry_msgs import PoseStamped
from lcmtools.types.nav_msgs import Path
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.control import Control
from lcmtools_sim.engines import chosen_engine, engine_version
from lcmtools_sim.follow import Followers, LeaderClock
from lcmtools_sim.loop import Loop
from lcmtools_sim.options import Options
from lcmtools_sim.scene import MarkedPath, Scene, contents
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation
from lcmtools_sim.view import LatchedPublisher, View

_TIMEOUTS = StopTimeouts(interrupt=2.0, terminate=1.0)  # of the window


def simulate(scene: Scene, options: Options, arguments: Sequence[str]) -> None:
    """Simulate a scene on the bus until a request to end, or for the given duration.

    ``arguments`` is the whole command line, for the node's name, remaps and the bus.

    Raises:
        MissingExtra: A package of the extra is not installed.
        LcmtoolsError: The bus cannot be reached.
    """
    engine = chosen_engine(options.engine)
    lcmtools.init(arguments)  # before the engine: now Ctrl-C ends the program quietly
    try:
        leads = not options.follow
        with ExitStack() as stack:
            simulation = stack.enter_context(Simulation(scene, engine=engine, leads=leads))
            if options.view:
                stack.enter_context(_opened_window(arguments))
            _run(simulation, options, engine_version(engine))
    finally:
        lcmtools.shutdown()


def _run(simulation: Simulation, options: Options, engine: str) -> None:
    scene = simulation.scene
    with lcmtools.Node(scene.node) as node:
        bridge = Bridge(node, simulation)
        view = View(node, simulation, whole=not options.follow)

        def refresh() -> None:
            bridge.refresh()
            view.refresh()

        pacer = Pacer(scene.dt / options.rate if options.rate else 0.0)
        last_step = round(options.duration / scene.dt) if options.duration else None
        make_loop = partial(Loop, simulation, bridge, go_on=lcmtools.ok, last_step=last_step)
        if options.follow:
            pacer = LeaderClock(node, simulation, refresh)
            loop = make_loop(pacer)
        else:
            loop = make_loop(pacer, let_step=Followers(node, simulation, bridge).wait)
        if options.paused:
            loop.pause()
        Control(node, simulation, loop, refresh)
        for path in () if options.follow else scene.paths:
            make = partial(path_message, path)
            LatchedPublisher(node, Path, path.topic, make, node.has_plain_listeners)
        log = node.get_logger()
        for line in (*scene.notes, *simulation.misplaced):
            log.warning(line)
        paused = "; paused: lcmtools sim resume starts it" if options.paused else ""
        log.info(f"simulating {scene.name} with {engine}: {contents(scene)}{paused}")
        if options.follow:
            log.info("waiting for the /clock of the process that leads")
            pacer.wait(lcmtools.ok, bridge.receive)
        loop.run()


def path_message(path: MarkedPath) -> Path:
    """Return the message of a path, in the frame world.

    Each pose points along the path; the time is left empty.
    """
    message, points = Path(), path.line.points
    message.header.frame_id = "world"
    for index, (x, y) in enumerate(points):
        (x0, y0), (x1, y1) = points[max(0, index - 1)], points[min(index + 1, len(points) - 1)]
        heading = math.atan2(y1 - y0, x1 - x0)
        pose = PoseStamped()
        pose.header.frame_id = "world"
        pose.pose.position.x, pose.pose.position.y = x, y
        turn = pose.pose.orientation
        turn.z, turn.w = math.sin(heading / 2), math.cos(heading / 2)
        message.poses.append(pose)
    return message


@contextmanager
def _opened_window(arguments: Sequence[str]) -> Iterator[None]:
    """Open ``lcmtools gui world`` on the same bus, in a process that ends with the context.

    It prints its address itself, or the reason if it cannot be opened; the simulator then goes on.
    """
    node, _ = split_arguments(arguments)
    bus = NodeArguments(lcm_url=node.lcm_url, domain=node.domain).words()
    command = [sys.executable, "-m", "lcmtools", "gui", "world", *bus]
    start = Start(command, os.environ, takes_terminal=True)
    with ProcessGuard() as guard, ChildProcess(start, guard, _TIMEOUTS):
        yield
