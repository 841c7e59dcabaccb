"""The payloads of many robots' messages, filled by arrays."""

import numpy as np

from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.types.nav_msgs import Odometry
from lcmtools_sim.sensors.payloads import Payloads


def template(name):
    message = Odometry()
    message.header.frame_id = name
    return PayloadTemplate(message, "twist.twist.linear", "header.stamp")


def test_each_payload_has_the_numbers_of_its_robot():
    robots = [("long/odom", 3), ("a/odom", 0), ("b/odom", 1), ("c/odom", 4)]
    speeds = np.array([0.5, -1.0, 9.0, 7.0, 1e300])
    filled = Payloads([(template(name), place) for name, place in robots]).fill(
        [(speeds, 0.25, speeds * 2), (3, 500)]
    )
    assert filled == [
        template(name).fill((speeds[place], 0.25, speeds[place] * 2), (3, 500))
        for name, place in robots
    ]


def test_they_keep_their_numbers_when_others_are_filled():
    payloads = Payloads([(template("a"), 0), (template("b"), 1)])
    first = payloads.fill([(np.array([1.0, 2.0]), 0.0, 0.0), (1, 0)])
    kept = list(first)
    payloads.fill([(np.array([3.0, 4.0]), 0.0, 0.0), (2, 0)])
    assert (
        first
        == kept
        == [
            template(name).fill((speed, 0.0, 0.0), (1, 0))
            for name, speed in (("a", 1.0), ("b", 2.0))
        ]
    )
