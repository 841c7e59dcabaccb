"""Pictures as messages: the bytes that other programs will read."""

import math
from io import BytesIO

import numpy as np
import pytest
from fixtures.plain_rays import cast, rays_of
from PIL import Image as PngFile

from lcmtools.messages.codec import decode, encode
from lcmtools.types.sensor_msgs import CompressedImage, Image, PointCloud2
from lcmtools_sim.geometry import from_euler
from lcmtools_sim.shapes import Cuboid, Part, Sphere
from lcmtools_sim.vision.camera import Camera, optical
from lcmtools_sim.vision.color import color_image
from lcmtools_sim.vision.messages import (
    METRES,
    MILLIMETRES,
    cloud_message,
    color_message,
    compressed_message,
    depth_message,
    in_millimetres,
)
from lcmtools_sim.vision.render import render
from lcmtools_sim.vision.solids import matrix, solids_of

CAMERA = Camera(80, 60, math.radians(57))
EYE, ROTATION = (0.1, 0.2, 0.6), optical(from_euler(0.1, 0.3, 0.2))
NEAR, FAR = 0.5, 8.0
ROW = np.array([[0.2, 0.5, 1.2344, 1.2346, 8.0, 8.1, np.inf, np.nan]], np.float32)


def points(depth):
    """The points in a cloud's message."""
    data = cloud_message(depth, CAMERA, NEAR, FAR).data
    return np.frombuffer(data, "<f4").reshape(*depth.shape, 3)


@pytest.fixture
def sight():
    parts = [Part(Cuboid((1, 1, 1)), (3, 0.5, 0.5)), Part(Sphere(0.3), (2, -0.3, 0.3))]
    return render(solids_of(parts, (0.5, 0.5, 0.5)), CAMERA, EYE, ROTATION)


def test_metres_are_float32_with_nan_outside_the_range():
    message = decode(Image, encode(depth_message(ROW, METRES, NEAR, FAR)))
    assert (message.height, message.width, message.step) == (1, 8, 32)
    assert (message.encoding, message.is_bigendian) == ("32FC1", 0)
    values = np.frombuffer(message.data, "<f4")
    np.testing.assert_array_equal(values[1:5], ROW[0, 1:5])
    assert np.isnan(values[[0, 5, 6, 7]]).all()


def test_millimetres_are_rounded_with_0_outside_the_range():
    message = decode(Image, encode(depth_message(ROW, MILLIMETRES, NEAR, FAR)))
    assert (message.height, message.width, message.step) == (1, 8, 16)
    assert (message.encoding, message.is_bigendian) == ("16UC1", 0)
    assert np.frombuffer(message.data, "<u2").tolist() == [0, 500, 1234, 1235, 8000, 0, 0, 0]


def test_what_16_bits_cannot_hold_is_no_reading():
    depth = np.array([[65.535, 65.54, 70.0]], np.float32)
    assert in_millimetres(depth, 0.0, 100.0).tolist() == [[65535, 0, 0]]


def test_another_encoding_is_refused():
    with pytest.raises(ValueError, match="no encoding of depth: mono8"):
        depth_message(ROW, "mono8", NEAR, FAR)


def test_colours_are_rgb8(sight):
    picture = color_image(sight)
    message = decode(Image, encode(color_message(picture)))
    assert (message.height, message.width, message.step) == (60, 80, 240)
    assert (message.encoding, message.is_bigendian) == ("rgb8", 0)
    assert message.data == picture.tobytes()


def test_compressed_pictures_are_png_files_of_the_same_pixels(sight):
    for picture in (color_image(sight), in_millimetres(sight.depth, NEAR, FAR)):
        message = decode(CompressedImage, encode(compressed_message(picture)))
        assert message.format == "png"
        np.testing.assert_array_equal(np.asarray(PngFile.open(BytesIO(message.data))), picture)


def test_a_cloud_without_colours_is_three_floats_a_point(sight):
    message = decode(PointCloud2, encode(cloud_message(sight.depth, CAMERA, NEAR, FAR)))
    assert (message.height, message.width) == (60, 80)
    assert (message.point_step, message.row_step) == (12, 960)
    assert (message.is_bigendian, message.is_dense) == (False, False)
    described = [
        (field.name, field.offset, field.datatype, field.count) for field in message.fields
    ]
    assert described == [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1)]
    assert len(message.data) == 60 * 960


def test_a_clouds_points_are_the_depth_along_the_rays(sight):
    cloud = points(sight.depth)
    valid = (sight.depth >= NEAR) & (sight.depth <= FAR)
    expected = rays_of(CAMERA) * sight.depth[..., None]
    assert 0 < valid.sum() < valid.size
    assert np.isnan(cloud[~valid]).all()
    np.testing.assert_allclose(cloud[valid], expected[valid], atol=1e-5)


def test_a_clouds_points_lie_on_the_solids(sight):
    turn = matrix(ROTATION)
    cloud = points(sight.depth)[sight.solid == 1] @ turn.T + EYE
    np.testing.assert_allclose(np.linalg.norm(cloud - (2, -0.3, 0.3), axis=1), 0.3, atol=1e-5)
    rays = rays_of(CAMERA)[sight.solid == 1] @ turn.T
    ball = solids_of([Part(Sphere(0.3), (2, -0.3, 0.3))])
    distances = cast(ball, EYE, rays)
    np.testing.assert_allclose(np.linalg.norm(cloud - EYE, axis=1), distances, atol=1e-4)


def test_a_clouds_colours_are_those_of_its_pixels(sight):
    picture = color_image(sight)
    message = decode(PointCloud2, encode(cloud_message(sight.depth, CAMERA, NEAR, FAR, picture)))
    data = np.frombuffer(message.data, np.uint8).reshape(60, 80, 16)
    assert (message.point_step, message.row_step) == (16, 1280)
    assert (message.fields[3].name, message.fields[3].offset) == ("rgb", 12)
    assert message.fields[3].datatype == 7
    np.testing.assert_array_equal(data[:, :, 14:11:-1], picture)  # 0x00RRGGBB, little-endian
