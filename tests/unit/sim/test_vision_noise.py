"""The statistics of a depth camera's noise."""

import math

import numpy as np
import pytest

from lcmtools_sim.sensors.cameras import noisy

KINECT, KINECT_STEP = 1.4e-3, 2.85e-3
SHAPE = 400, 500


def flat(depth):
    return np.full(SHAPE, depth, np.float32)


def test_without_noise_depth_is_exact():
    depth = np.array([[0.7, 3.3, np.inf]], np.float32)
    assert noisy(depth, np.random.default_rng(1)) is depth


@pytest.mark.parametrize("depth", [0.5, 1.0, 3.0, 5.0])
def test_the_kinects_error_grows_with_the_square_of_the_depth(depth):
    error = noisy(flat(depth), np.random.default_rng(1), spread=KINECT).astype(float) - depth
    sigma = 1.4e-3 * depth**2
    assert error.std() == pytest.approx(sigma, rel=0.01)
    assert abs(error.mean()) < 4 * sigma / math.sqrt(error.size)
    assert np.mean(np.abs(error) < sigma) == pytest.approx(0.6827, abs=0.01)


def test_pixels_err_independently():
    error = noisy(flat(2.0), np.random.default_rng(1), spread=KINECT).astype(float) - 2
    assert abs(np.corrcoef(error[:, 1:].ravel(), error[:, :-1].ravel())[0, 1]) < 0.01


@pytest.mark.parametrize("depth", [1.0, 4.0])
def test_readings_are_whole_steps_of_disparity(depth):
    around = np.linspace(depth * 0.98, depth * 1.02, 4000, dtype=np.float32)[None]
    readings = noisy(around, np.random.default_rng(1), step=KINECT_STEP)
    steps = np.diff(np.unique(readings))
    assert steps.mean() == pytest.approx(KINECT_STEP * depth**2, rel=0.05)
    assert np.abs(readings - around).max() < 0.55 * KINECT_STEP * (depth * 1.02) ** 2


def test_so_many_readings_drop_out():
    readings = noisy(flat(2.0), np.random.default_rng(1), dropout=0.1)
    assert np.isnan(readings).mean() == pytest.approx(0.1, abs=0.005)
    assert (readings[~np.isnan(readings)] == 2).all()


def test_where_nothing_is_hit_noise_finds_nothing():
    random = np.random.default_rng(1)
    assert (noisy(flat(math.inf), random, spread=KINECT, step=KINECT_STEP) == math.inf).all()


def test_the_same_seed_gives_the_same_readings_and_float32():
    first, again, other = (
        noisy(flat(2.0), np.random.default_rng(seed), spread=KINECT, step=KINECT_STEP, dropout=0.05)
        for seed in (7, 7, 8)
    )
    assert first.dtype == np.float32
    np.testing.assert_array_equal(first, again)
    assert (first != other).mean() > 0.5
