"""Mass and inertia of what is joined from several bodies.

Symbols are those of the textbooks: the inertia tensor about the centre of mass, and the parallel
axis theorem (Steiner) for any other point.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lcmtools_sim.rotation import Vector, axes
from lcmtools_sim.world_file.frames import Frame

Matrix = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Inertial:
    """How one body resists.

    Attributes:
        mass: [kg]
        frame: Of the centre of mass, and of the axes that the tensor is given about.
        tensor: Inertia xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2].
    """

    mass: float
    frame: Frame
    tensor: tuple[float, float, float, float, float, float]


def centre_of_mass(bodies: Iterable[Inertial]) -> tuple[float, Vector]:
    """The mass of all [kg], and where their common centre is; the origin where there is none."""
    known = list(bodies)
    mass = sum(body.mass for body in known)
    if not mass:
        return 0.0, (0.0, 0.0, 0.0)
    x, y, z = (sum(body.mass * body.frame.position[i] for body in known) / mass for i in range(3))
    return mass, (x, y, z)


def moments(bodies: Iterable[Inertial], point: Vector) -> Vector:
    """The moments of inertia of all about x, y, z through a point [kg m^2]."""
    total = np.zeros((3, 3))
    for body in bodies:
        turned = np.array(axes(body.frame.rotation)).T
        lever = np.subtract(body.frame.position, point)
        steiner = np.dot(lever, lever) * np.eye(3) - np.outer(lever, lever)
        total += turned @ _matrix(body) @ turned.T + body.mass * steiner
    x, y, z = np.diag(total).tolist()
    return x, y, z


def _matrix(body: Inertial) -> Matrix:
    xx, yy, zz, xy, xz, yz = body.tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
