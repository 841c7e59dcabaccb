"""The speed of pictures and scans of a world, beside the engine's own software renderer and rays.

The world has 26 boxes: four walls, four tables of five pieces, two crates. Rows: pictures as a
camera turns round in its middle; milliseconds (median), and how many times faster than pybullet's
getCameraImage (TinyRenderer, shadows off), in turn in one run. Then the steps after a picture.

    python bench/vision.py [--pictures N]
"""

import math
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
import pybullet
from common import parser, show

from lcmtools_sim.geometry import Vector, from_euler
from lcmtools_sim.sensors.cameras import noisy
from lcmtools_sim.shapes import Cuboid, Part
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.messages import (
    METRES,
    cloud_message,
    compressed_message,
    depth_message,
    in_millimetres,
)
from lcmtools_sim.vision.render import Rendering, render
from lcmtools_sim.vision.scan import Numbers, Scanner
from lcmtools_sim.vision.solids import Floats, solids_of
from lcmtools_sim.vision.surfaces import Floats32

EYE: Vector = (-1.0, 0.2, 0.4)
NEAR, FAR = 0.5, 8.0
FIELD_OF_VIEW = math.radians(57)
Work = Callable[[float], object]


def boxes() -> Iterator[Part]:
    """The world's."""
    for x, y, size in ((5, 0, (0.2, 10, 1)), (-5, 0, (0.2, 10, 1))):
        yield Part(Cuboid(size), (x, y, 0.5))
        yield Part(Cuboid((size[1], size[0], 1)), (y, x, 0.5))
    for x, y, yaw in ((2, 1, 0.3), (3, -2, 1.0), (-2, 2, 0.2), (-3, -3, 2.0)):
        turn = from_euler(0, 0, yaw)
        yield Part(Cuboid((1.2, 0.8, 0.04)), (x, y, 0.73), turn)
        for along in (-0.55, 0.55):
            for across in (-0.35, 0.35):
                dx = math.cos(yaw) * along - math.sin(yaw) * across
                dy = math.sin(yaw) * along + math.cos(yaw) * across
                yield Part(Cuboid((0.05, 0.05, 0.71)), (x + dx, y + dy, 0.355), turn)
    yield Part(Cuboid((0.5, 0.5, 0.5)), (2.5, -0.6, 0.25), from_euler(0, 0, 0.5))
    yield Part(Cuboid((0.5, 0.5, 0.5)), (4, 2.6, 0.25))


PARTS = tuple(boxes())
WORLD = solids_of(PARTS, (0.5, 0.5, 0.5))


def engine() -> int:
    """The same world in the engine; its client's number."""
    client: int = pybullet.connect(pybullet.DIRECT)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    pybullet.createMultiBody(0, plane, physicsClientId=client)
    for part in PARTS:
        assert isinstance(part.shape, Cuboid)
        half = [size / 2 for size in part.shape.size]
        kind = pybullet.GEOM_BOX
        solid = pybullet.createCollisionShape(kind, halfExtents=half, physicsClientId=client)
        looks = pybullet.createVisualShape(kind, halfExtents=half, physicsClientId=client)
        place = part.position, part.rotation
        pybullet.createMultiBody(0, solid, looks, *place, physicsClientId=client)
    return client


def frustum(camera: Camera, near: float) -> tuple[float, float, float, float]:
    """The picture's edges at distance ``near`` [m], as OpenGL's glFrustum takes them (y up)."""
    half_width = near * camera.width / 2 / camera.focal_length
    half_height = near * camera.height / 2 / camera.focal_length
    return -half_width, half_width, -half_height, half_height


def engine_picture(client: int, camera: Camera, yaw: float) -> object:
    """The picture of the engine's renderer."""
    ahead = EYE[0] + math.cos(yaw), EYE[1] + math.sin(yaw), EYE[2]
    return pybullet.getCameraImage(
        camera.width,
        camera.height,
        pybullet.computeViewMatrix(EYE, ahead, (0, 0, 1)),
        pybullet.computeProjectionMatrix(*frustum(camera, 0.05), 0.05, 100.0),
        shadow=0,
        renderer=pybullet.ER_TINY_RENDERER,
        physicsClientId=client,
    )


def engine_rays(client: int, directions: np.ndarray) -> object:
    """The engine's rays as long as a laser's."""
    ends = (np.array(EYE) + 10 * directions).tolist()
    return pybullet.rayTestBatch([EYE] * len(ends), ends, physicsClientId=client)


def measure(works: Sequence[Work], count: int) -> list[float]:
    """Milliseconds of each, in turn at ``count`` headings, the median."""
    times: list[list[float]] = [[] for _ in works]
    for number in range(count):
        for work, spent in zip(works, times, strict=True):
            begun = time.perf_counter()
            work(number * math.tau / count)
            spent.append(1e3 * (time.perf_counter() - begun))
    return [statistics.median(spent) for spent in times]


def seen(camera: Camera, yaw: float) -> Rendering:
    """The view of this project's renderer."""
    return render(WORLD, camera, EYE, optical(from_euler(0, 0, yaw)), FAR)


def compare_pictures(client: int, count: int) -> None:
    """Print the table of pictures."""
    rows = []
    for size in ((160, 120), (320, 240), (640, 480)):
        camera = Camera(*size, FIELD_OF_VIEW)
        theirs, depth, color = measure(
            [
                partial(engine_picture, client, camera),
                partial(seen, camera),
                lambda yaw, camera=camera: color_image(seen(camera, yaw)),
            ],
            count,
        )
        name = f"{camera.width}x{camera.height}"
        rows.append((name, theirs, depth, theirs / depth, color, theirs / color))
    columns = ("pixels", "pybullet", "depth", "times faster", "depth and colour", "times faster")
    show("pictures, 26 boxes [ms]", columns, rows)


class EveryPair(Scanner):
    """A scanner that tests each ray with each solid."""

    def _pairs(self, arcs: Floats) -> tuple[Numbers, Numbers]:
        everywhere = np.broadcast_to(((-np.pi,), (np.pi,)), arcs.shape)
        return super()._pairs(everywhere)


def compare_lasers(client: int, count: int) -> None:
    """Print the table of lasers; only the scans turn round.

    "every pair" tests each ray with each solid, as if all bounding circles were around the scanner.
    """
    rows, bodies = [], [(WORLD, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))]
    for number in (200, 720):
        angles = np.linspace(-1, 1, number)
        rays = np.stack((np.cos(angles), np.sin(angles), np.zeros(number)), axis=-1)
        scanner, plain = Scanner(angles, 10.0), EveryPair(angles, 10.0)
        theirs, pairs, ours = measure(
            [
                lambda _yaw, rays=rays: engine_rays(client, rays),
                lambda yaw, plain=plain: plain.scan(EYE, from_euler(0, 0, yaw), bodies),
                lambda yaw, scanner=scanner: scanner.scan(EYE, from_euler(0, 0, yaw), bodies),
            ],
            count,
        )
        rows.append((f"{number} rays", theirs, pairs, ours, theirs / ours))
    columns = ("rays", "pybullet", "every pair", "scan", "times faster")
    show("lasers, 26 boxes [ms]", columns, rows)


def follow_ups(count: int) -> None:
    """Print the time of each step after a picture."""
    camera, random = Camera(640, 480, FIELD_OF_VIEW), np.random.default_rng(1)
    sight = seen(camera, 0.0)
    color, rough = color_image(sight), noisy(sight.depth, random, spread=1.4e-3)
    works = {
        "noise": lambda _yaw: noisy(sight.depth, random, spread=1.4e-3),
        "32FC1": lambda _yaw: depth_message(sight.depth, METRES, NEAR, FAR),
        "16UC1": lambda _yaw: in_millimetres(sight.depth, NEAR, FAR),
        "PNG of depth": lambda _yaw: png(sight.depth),
        "PNG of depth with noise": lambda _yaw: png(rough),
        "PNG of colour": lambda _yaw: compressed_message(color),
        "point cloud": lambda _yaw: cloud_message(sight.depth, camera, NEAR, FAR),
        "point cloud with colour": lambda _yaw: cloud_message(
            sight.depth, camera, NEAR, FAR, color
        ),
    }
    times = measure(list(works.values()), count)
    show("then, for 640x480 [ms]", ("", "time"), list(zip(works, times, strict=True)))


def png(depth: Floats32) -> object:
    """Depth as a compressed message."""
    return compressed_message(in_millimetres(depth, NEAR, FAR))


def main() -> None:
    """Measure and print the tables."""
    command = parser(__doc__)
    command.add_argument("--pictures", type=int, default=36, help="headings of the camera")
    command.add_argument("--quick", action="store_true", help="6 pictures: rough figures")
    arguments = command.parse_args()
    count = 6 if arguments.quick else arguments.pictures
    client = engine()
    compare_pictures(client, count)
    compare_lasers(client, count)
    follow_ups(count)
    pybullet.disconnect(client)


if __name__ == "__main__":
    main()
