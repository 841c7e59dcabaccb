"""The pinhole camera: pixels, rays, projection and camera_info tell the same."""

import math

import numpy as np
import pytest
from fixtures.plain_rays import project, rays_of
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.messages.codec import decode, encode
from lcmtools.types.sensor_msgs import CameraInfo
from lcmtools_sim.geometry import axes, from_euler
from lcmtools_sim.shapes import Part, Sphere
from lcmtools_sim.vision.camera import OPTICAL, Camera, optical
from lcmtools_sim.vision.render import render
from lcmtools_sim.vision.solids import matrix, solids_of

KINECT = Camera(640, 480, math.radians(57))

angles = st.floats(-math.pi, math.pi)


def test_a_kinects_focal_length_comes_from_its_field_of_view():
    assert KINECT.focal_length == pytest.approx(589.37, abs=0.005)
    assert KINECT.centre == (319.5, 239.5)


@pytest.mark.parametrize(
    ("width", "height", "field_of_view"),
    [(0, 480, 1.0), (640, -1, 1.0), (640, 480, 0.0), (640, 480, 57.0), (640, 480, math.nan)],
)
def test_a_camera_that_could_make_no_picture_is_refused(width, height, field_of_view):
    with pytest.raises(ValueError, match=r"pixels|field of view"):
        Camera(width, height, field_of_view)


def test_the_optical_frame_looks_along_x_with_y_to_the_left():
    right, down, forward = axes(OPTICAL)
    assert right == pytest.approx((0, -1, 0))
    assert down == pytest.approx((0, 0, -1))
    assert forward == pytest.approx((1, 0, 0))


@given(angles, angles, angles)
def test_the_optical_rotation_is_the_cameras_times_the_fixed_one(roll, pitch, yaw):
    rotation = from_euler(roll, pitch, yaw)
    np.testing.assert_allclose(
        matrix(optical(rotation)), matrix(rotation) @ matrix(OPTICAL), atol=1e-12
    )


def test_every_ray_projects_to_its_own_pixel():
    rows, columns = np.mgrid[: KINECT.height, : KINECT.width]
    pixels = project(KINECT, rays_of(KINECT) * 3.7)
    np.testing.assert_allclose(pixels[..., 0], columns, atol=1e-9)
    np.testing.assert_allclose(pixels[..., 1], rows, atol=1e-9)


def test_camera_info_is_that_of_a_centred_pinhole():
    info = decode(CameraInfo, encode(KINECT.info()))
    focal = KINECT.focal_length
    assert (info.width, info.height) == (640, 480)
    assert info.distortion_model == "plumb_bob"
    assert info.D == (0, 0, 0, 0, 0)
    assert list(info.K) == [focal, 0, 319.5, 0, focal, 239.5, 0, 0, 1]
    assert info.R == (1, 0, 0, 0, 1, 0, 0, 0, 1)
    assert list(info.P) == [focal, 0, 319.5, 0, 0, focal, 239.5, 0, 0, 0, 1, 0]


@given(st.floats(1, 6), st.floats(-0.4, 0.4), st.floats(-0.3, 0.3))
def test_camera_info_says_at_which_pixel_a_point_is_seen(z, across, down):
    point = np.array((across * z, down * z, z))
    position = (point[2], -point[0], -point[1])  # in the world of a camera that looks along x
    camera = Camera(320, 240, math.radians(57))
    message = camera.info()
    u, v, w = np.array(message.P).reshape(3, 4) @ (*point, 1)
    ball = solids_of([Part(Sphere(0.03 * z), position)])
    rows, columns = np.nonzero(np.isfinite(render(ball, camera, (0, 0, 0), OPTICAL).depth))
    if 12 < u / w < 307 and 12 < v / w < 227:  # all of the ball in the picture
        assert columns.mean() == pytest.approx(u / w, abs=0.5)
        assert rows.mean() == pytest.approx(v / w, abs=0.5)
