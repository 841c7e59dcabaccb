"""Colour pictures: registered with the depth, shaded by the way a surface faces."""

import math

import numpy as np
from fixtures.plain_rays import project

from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import Cuboid, Cylinder, Part, Sphere
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import SKY_COLOR, SUN, color_image
from lcmtools_sim.vision.render import GROUND, SKY, render
from lcmtools_sim.vision.solids import solids_of

CAMERA = Camera(161, 121, math.radians(57))
AHEAD = optical((0.0, 0.0, 0.0, 1.0))
RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def sight_of(*parts):
    return render(solids_of(parts, BLUE), CAMERA, (0, 0, 0.3), AHEAD)


def hues(picture):
    """Which of the three channels is above zero, as bits."""
    return (picture > 0) @ np.array((1, 2, 4))


def test_each_pixel_has_the_colour_of_what_its_depth_belongs_to():
    sight = sight_of(
        Part(Cuboid((0.5, 0.4, 0.5)), (3, 0.5, 0.2), from_euler(0.1, 0.2, 0.7), RED),
        Part(Sphere(0.3), (2, -0.5, 0.2), color=GREEN),
        Part(Cylinder(0.2, 0.5), (4, -0.2, 0.2), from_euler(0.5, 0, 0), RED),
    )
    hue = hues(color_image(sight))
    assert color_image(sight).shape == (121, 161, 3)
    for number, expected in ((0, 1), (1, 2), (2, 1), (GROUND, 4), (SKY, 7)):
        assert (sight.solid == number).any()
        assert (hue[sight.solid == number] == expected).all()


def test_the_sky_has_its_own_colour():
    picture = color_image(sight_of())
    assert picture[0, 0].tolist() == [round(255 * level) for level in SKY_COLOR]


def test_the_faces_of_a_box_differ_and_each_is_even():
    box = Part(Cuboid((1, 1, 0.2)), (3, 0, 0), from_euler(0, 0, 0.6), RED)
    sight = sight_of(box)
    shades = set(color_image(sight)[sight.solid == 0][:, 0].tolist())
    assert len(shades) == 3


def test_a_ball_is_brightest_where_it_faces_the_sun():
    sight = sight_of(Part(Sphere(0.5), (3, 0, 0.3), color=RED))
    red = np.where(sight.solid == 0, color_image(sight)[:, :, 0], 0).astype(float)
    toward = project(CAMERA, (-0.5 * SUN[1], -0.5 * SUN[2], 3 + 0.5 * SUN[0]))
    row, column = np.unravel_index(red.argmax(), red.shape)
    assert abs(column - toward[0]) < 4
    assert abs(row - toward[1]) < 4


def test_a_cap_is_even_and_differs_from_the_side():
    tin = Part(Cylinder(0.5, 0.2), (2, 0, 0), color=RED)
    sight = sight_of(tin)
    red = color_image(sight)[:, :, 0]
    depth, (row, column) = sight.depth, np.nonzero(sight.solid == 0)
    height = 0.3 - depth[row, column] * (row - 60) / CAMERA.focal_length
    cap = red[row, column][height > 0.09999]
    assert len(set(cap.tolist())) == 1
    assert len(set(red[row, column][height < 0.09].tolist())) > 10
