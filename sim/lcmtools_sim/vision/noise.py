"""The errors of a real depth camera.

Source of the Kinect's numbers: K. Khoshelham, S. Oude Elberink, Accuracy and Resolution of Kinect
Depth Data for Indoor Mapping Applications, Sensors 12(2), 2012: the random error grows with the
square of the depth, 1.4 mm at 1 m and about 4 cm at 5 m; so does the resolution, 2.85 mm at 1 m.
"""

import numpy as np

from lcmtools_sim.vision.surfaces import Floats32


def noisy(
    depth: Floats32,
    random: np.random.Generator,
    *,
    spread: float = 0.0,
    step: float = 0.0,
    dropout: float = 0.0,
) -> Floats32:
    """Return depth [m] with the errors; inf stays inf, a dropped reading is NaN.

    The number of random numbers depends only on the picture's size, so that runs are repeatable.

    Args:
        depth: Exact depth [m].
        random: The random numbers.
        spread: Standard deviation at 1 m [m]; at z metres it is z^2 times this.
        step: Distance between two neighbouring readings at 1 m [m]; at z metres it is z^2 times
            this, because the sensor counts steps of disparity, which is 1/z. With 0, depth is
            continuous, and 16UC1 rounds it to millimetres. The spread was measured including the
            steps: using both adds z^2 step / sqrt(12) to it, in quadrature.
        dropout: Share of the pixels without a reading, 0 to 1.
    """
    if spread:
        error = random.standard_normal(depth.shape, np.float32) * np.float32(spread)
        with np.errstate(invalid="ignore"):
            depth = np.where(np.isinf(depth), depth, depth + depth * depth * error)
    if step:
        size = np.float32(step)
        with np.errstate(divide="ignore"):
            depth = np.float32(1) / (np.rint(1 / (depth * size)) * size)
    if dropout:
        lost = random.random(depth.shape, np.float32) < dropout
        depth = np.where(lost, np.float32(np.nan), depth)
    return depth
