"""reading_laser: a scan in one line."""

import math

import pytest

from lcmtools.labs.nodes.reading_laser import ReadingLaser, describe
from lcmtools.types.sensor_msgs import LaserScan


def scan(*ranges, first=-1.0, step=1.0):
    message = LaserScan()
    message.angle_min, message.angle_increment = first, step
    message.range_min, message.range_max = 0.05, 10.0
    message.ranges, message.ranges_length = list(ranges), len(ranges)
    return message


@pytest.mark.parametrize(
    ("message", "line"),
    [
        (
            scan(2.0, math.inf, 1.5),
            "3 ranges: right 2.00 m, ahead nothing, left 1.50 m, nearest 1.50 m at 57 degrees left",
        ),
        (
            scan(2.0, 3.0, 1.5, first=1.0, step=-1.0),
            "3 ranges: right 1.50 m, ahead 3.00 m, left 2.00 m, nearest 1.50 m at 57 degrees right",
        ),
        (
            scan(0.01, math.nan, 11.0),
            "3 ranges: right nothing, ahead nothing, left nothing, nothing from 0.05 to 10 m",
        ),
        (scan(), "0 ranges that cannot be read"),
        (scan(1.0, first=math.nan), "1 ranges that cannot be read"),
    ],
)
def test_scan_is_told_in_a_line(message, line):
    assert describe(message) == line


def test_lines_come_twice_a_second(bench, capsys):
    bench.start(ReadingLaser, "_use_sim_time:=true")
    for time in range(1, 13):
        bench.advance_time(time / 10)
        bench.publish("/dolly/laser_scan", scan(1.0, 2.0, 3.0))
    assert capsys.readouterr().err.count("ahead 2.00 m") == 3
