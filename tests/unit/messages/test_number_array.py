"""Arrays of numbers in decoded messages: lists and tuples, as far as users' code can tell."""

import copy
import json
import pickle
from array import array
from collections.abc import MutableSequence

import numpy as np
import pytest

from lcmtools.messages.codec import decode, encode
from lcmtools.messages.number_array import NumberArray
from lcmtools.messages.plain import to_json, to_plain
from lcmtools.messages.text import format_message
from lcmtools.types.geometry_msgs import PoseWithCovariance
from lcmtools.types.nav_msgs import OccupancyGrid
from lcmtools.types.sensor_msgs import LaserScan

RANGES = [1.0, 0.5, 2.25]


@pytest.fixture
def ranges():
    """Return the ranges of a decoded scan."""
    scan = LaserScan()
    scan.ranges = RANGES
    received = decode(LaserScan, encode(scan)).ranges
    assert type(received) is NumberArray
    return received


def test_it_has_a_sequences_interface(ranges):
    assert (len(ranges), ranges[0], ranges[-1], list(ranges)) == (3, 1.0, 2.25, RANGES)
    assert (min(ranges), max(ranges), sum(ranges), sorted(ranges)) == (
        0.5,
        2.25,
        3.75,
        [0.5, 1, 2.25],
    )
    assert (ranges.index(0.5), ranges.count(1.0), 2.25 in ranges, 3.0 in ranges) == (
        1,
        1,
        True,
        False,
    )
    assert list(reversed(ranges)) == [2.25, 0.5, 1.0]
    assert [*ranges[:2], *ranges[::2]] == [1.0, 0.5, 1.0, 2.25]
    assert isinstance(ranges, MutableSequence)
    assert ranges
    first, *others = ranges
    assert (first, others) == (1.0, [0.5, 2.25])


def test_it_compares_with_lists_tuples_and_its_like(ranges):
    assert ranges == RANGES
    assert RANGES.__eq__(ranges) is NotImplemented  # so that "RANGES == ranges" asks it
    assert ranges == tuple(RANGES)
    assert ranges == array("d", RANGES)
    assert ranges == copy.copy(ranges)
    assert ranges != RANGES[:2]
    assert ranges != (1.0, 0.5, 9.0)
    assert ranges != "text"
    assert ranges < [2.0]
    assert ranges >= (1.0, 0.5)
    assert ranges <= array("f", [2.0])
    assert not ranges > (3.0,)
    assert (ranges == np.array(RANGES)).all()


def test_it_prints_like_a_list(ranges):
    assert (str(ranges), repr(ranges), f"{ranges}") == ("[1.0, 0.5, 2.25]",) * 3


def test_it_joins_lists_and_tuples(ranges):
    assert ranges + RANGES == RANGES * 2
    assert tuple(RANGES) + ranges == RANGES * 2
    assert ranges + ranges == RANGES * 2
    assert ranges + ranges[:1] == [*RANGES, 1.0]
    assert ranges * 2 == RANGES * 2
    assert (ranges + np.ones(3)).tolist() == [2.0, 1.5, 3.25]
    assert (np.ones(3) + ranges).tolist() == [2.0, 1.5, 3.25]
    with pytest.raises(TypeError):
        ranges + 1


def test_it_can_be_changed_and_sent_again(ranges):
    ranges[0] = 3.5
    ranges.append(4.0)
    ranges.extend([5.0])
    assert ranges.pop(1) == 0.5
    scan = LaserScan()
    scan.ranges = ranges
    assert decode(LaserScan, encode(scan)).ranges == [3.5, 2.25, 4.0, 5.0]
    with pytest.raises(TypeError):
        hash(ranges)


def test_it_survives_copies_and_pickling(ranges):
    scan = LaserScan()
    scan.ranges = ranges
    for again in (
        copy.copy(ranges),
        copy.deepcopy(ranges),
        copy.deepcopy(scan).ranges,
        *(pickle.loads(pickle.dumps(ranges, protocol)) for protocol in range(6)),  # noqa: S301 - ours
    ):
        assert type(again) is NumberArray
        assert again == RANGES
        assert again is not ranges


def test_numpy_takes_it_without_a_copy(ranges):
    view = np.asarray(ranges)
    assert view.dtype == np.float32
    view[0] = 7.0
    assert ranges[0] == 7.0


def test_texts_have_its_numbers(ranges):
    scan = LaserScan()
    scan.ranges = ranges
    assert "ranges: [1.0, 0.5, 2.25]\n" in format_message(scan)
    assert '"ranges":[1.0,0.5,2.25]' in to_json(scan)
    assert to_plain(scan)["ranges"] == RANGES
    assert json.dumps(list(ranges)) == "[1.0, 0.5, 2.25]"


def test_int8_keeps_its_sign_and_refuses_what_it_cannot_hold():
    grid = OccupancyGrid()
    grid.data = [-1, 0, 100]
    received = decode(OccupancyGrid, encode(grid))
    assert received.data == [-1, 0, 100]
    with pytest.raises(OverflowError):
        received.data[0] = 200


def test_short_arrays_of_fixed_size_are_tuples():
    assert decode(PoseWithCovariance, encode(PoseWithCovariance())).covariance == (0.0,) * 36
