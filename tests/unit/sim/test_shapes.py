"""Centres and moments of inertia of shapes, by the textbooks' formulas. Metres, kg."""

import math

import pytest

from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import (
    Cuboid,
    Cylinder,
    Part,
    Sphere,
    centre_of_mass,
    inertials_of,
    moments,
)


def centre(parts):
    return centre_of_mass(inertials_of(parts, 1.0))[1]


def moments_about_centre(parts, mass):
    return moments(inertials_of(parts, mass), centre(parts))


@pytest.mark.parametrize(
    ("shape", "unit_moments"),
    [
        (Cuboid((1, 2, 3)), (13 / 12, 10 / 12, 5 / 12)),
        (Cylinder(0.5, 2), (0.25 / 4 + 4 / 12, 0.25 / 4 + 4 / 12, 0.25 / 2)),
        (Sphere(0.5), (0.1, 0.1, 0.1)),
    ],
)
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (5.0, -2.0, 1.0)])
def test_one_shape_resists_as_the_textbook_says_wherever_it_is(shape, unit_moments, place):
    part = Part(shape, place)
    assert centre([part]) == pytest.approx(place)
    assert moments_about_centre([part], 7.0) == pytest.approx(
        [7 * moment for moment in unit_moments]
    )


def test_a_shape_that_is_turned_has_its_moments_about_other_axes():
    lying = Part(Cylinder(0.5, 2), rotation=from_euler(0, math.pi / 2, 0))
    along, across = 0.25 / 2, 0.25 / 4 + 4 / 12
    assert moments_about_centre([lying], 1.0) == pytest.approx((along, across, across))


def test_two_halves_are_the_whole_and_a_larger_one_counts_for_more():
    halves = [Part(Cuboid((1, 2, 3)), (x, 0.0, 0.0)) for x in (3.5, 4.5)]
    assert centre(halves) == pytest.approx((4, 0, 0))
    assert moments_about_centre(halves, 12.0) == pytest.approx((13, 13, 8))
    assert centre([Part(Sphere(2), (9, 0, 0)), Part(Sphere(1))]) == pytest.approx((8, 0, 0))
