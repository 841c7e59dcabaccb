"""The simulator's command: answers to requests for information, and running a world.

Requests (--version, --list-worlds, --print-world, --check) need no bus, and only --check uses an
engine, to find overlaps at the start.
"""

import signal
import sys
import threading
from collections.abc import Sequence
from dataclasses import replace

from lcmtools import __version__
from lcmtools.arguments import split_arguments
from lcmtools.errors import MissingExtra
from lcmtools.escapes import ESCAPES, ESCAPES_IN_LINES
from lcmtools_sim.engines import chosen_engine, engine_version
from lcmtools_sim.options import Options, parse_options
from lcmtools_sim.scene import Scene, contents, fleet, selected, with_robot
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import describe, find_world, world_names


def run(arguments: Sequence[str]) -> int:
    """Execute the command with these arguments; return its exit code.

    It is 1 if a world that is checked has parts that are left out. LcmtoolsError if the command is
    impossible.
    """
    _, own = split_arguments(arguments)
    options = parse_options(own)
    code = _inform(options)
    if code is not None:
        return code
    scene, options = overridden(read_scene(*find_world(options.world)), options)
    if threading.current_thread() is threading.main_thread():
        # Until the bus takes over, SIGTERM ends the program as quietly as Ctrl-C.
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    from lcmtools_sim.session import simulate

    simulate(scene, options, arguments)
    return 0


def _inform(options: Options) -> int | None:
    """Answer a request for information, and return the exit code; None if it is none."""
    code = 0
    if options.version:
        text = f"lcmtools {__version__}, {engine_version(chosen_engine(options.engine))}"
    elif options.list_worlds:
        width = max(map(len, world_names()))
        text = "\n".join(f"{name:<{width}}  {describe(name)}" for name in world_names())
    elif options.print_world is not None:
        text = find_world(options.print_world)[0].rstrip()
    elif options.check is not None:
        scene = read_scene(*find_world(options.check))
        for note in scene.notes:
            _warn(note)
        _check_starts(scene, options.engine)
        code = 1 if scene.notes else 0
        text = f"{options.check}: {'read in part' if code else 'ok'}, {contents(scene)}"
    else:
        return None
    print(text.translate(ESCAPES_IN_LINES))  # noqa: T201 - the command's edge
    return code


def _warn(text: str) -> None:
    line = f"lcmtools run sim: {text}".translate(ESCAPES)
    print(line, file=sys.stderr)  # noqa: T201 - the command's edge


def _check_starts(scene: Scene, engine: str) -> None:
    """Refuse robots that start inside a body, and warn of such objects, if there is an engine."""
    from lcmtools_sim.simulation import Simulation

    try:
        with Simulation(scene, engine=engine) as simulation:
            notes = simulation.misplaced
    except MissingExtra:
        notes = ["whether something starts inside something else is not checked without an engine"]
    for note in notes:
        _warn(note)


def overridden(scene: Scene, options: Options) -> tuple[Scene, Options]:
    """Return the scene with the command line's changes, and the options with ``follow`` set."""
    if options.seed is not None:
        scene = replace(scene, seed=options.seed)
    for model, pose in options.added:
        scene = with_robot(scene, model, pose)
    if options.robots is not None:
        scene = fleet(scene, options.robots)
    part = selected(scene, options.only) if options.only else scene
    if not part.robots or not (options.follow or part.robots[0] != scene.robots[0]):
        return part, options
    # A follower needs another node name than the leader.
    first = part.robots[0]
    node = f"{scene.node}_{first.namespace.strip('/').replace('/', '_') or first.model.name}"
    return replace(part, node=node), replace(options, follow=True)
