"""Speed of encoding and decoding: lcmtools beside the code that lcm-gen writes.

Both decode the same payload and encode what they decoded; "of lists" is ours with lists for arrays.
Each figure is the median of alternating rounds, in microseconds for one message; the ratio is
lcm-gen's time by ours (above 1: ours is faster). lcmtools checks what it is given and sets length
fields by itself; lcm-gen's code does neither. A template is filled with new numbers; the ratio is
the time of making a message with them and encoding it by that. The text is what ``echo`` prints,
beside PyYAML's writer in C, which is given the message as a dict already.
"""

import timeit
from collections.abc import Callable, Sequence
from statistics import median
from typing import Protocol

import yaml
from common import rounds_asked, show

from lcmtools import message_value
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.payload_template import PayloadTemplate
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.text import format_message
from lcmtools.types.geometry_msgs import TransformStamped, Twist
from lcmtools.types.nav_msgs import OccupancyGrid, Odometry
from lcmtools.types.sensor_msgs import Image, JointState, LaserScan, PointCloud2
from lcmtools.types.tf2_msgs import TFMessage

message_value.settle_lengths = lambda _: None  # lcm-gen's encoder itself does no such thing
_ROUND = 0.01  # [s] that one call is repeated before it is the next one's turn


class Generated(Message, Protocol):
    """The classes of lcm-gen, which have a decoder of their own."""

    @classmethod
    def decode(cls, data: bytes) -> "Generated":
        """The message in a payload."""


def samples() -> dict[str, Generated]:
    """The messages, with values that are not all zero."""
    twist, odometry, joints, scan, cloud, grid, image, transforms = (
        Twist(), Odometry(), JointState(), LaserScan(), PointCloud2(), OccupancyGrid(), Image(),
        TFMessage(),
    )  # fmt: skip
    twist.linear.x, twist.angular.z = 0.5, 0.3
    odometry.header.frame_id, odometry.child_frame_id = "odom", "base_link"
    odometry.pose.pose.position.x, odometry.pose.covariance = 1.5, [0.001] * 36
    joints.name = [f"joint_{i}" for i in range(12)]
    joints.position = joints.velocity = joints.effort = [0.1 * i for i in range(12)]
    scan.ranges = [1.0 + i / 360 for i in range(360)]
    cloud.data, grid.data = bytes(1_000_000), [0, 100] * 20_000
    image.width, image.height, image.encoding, image.step = 640, 480, "rgb8", 3 * 640
    image.data = bytes(3 * 640 * 480)
    transforms.transforms = [_transform(i) for i in range(10)]
    return {
        "Twist": twist,
        "Odometry": odometry,
        "JointState 12": joints,
        "LaserScan 360": scan,
        "PointCloud2 1 MB": cloud,
        "OccupancyGrid 200x200": grid,
        "Image 640x480": image,
        "TFMessage 10": transforms,
    }


def _transform(number: int) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = "base_link", f"sensor_{number}"
    message.transform.translation.x, message.transform.rotation.w = number / 10, 1.0
    return message


def measure(rounds: int, *calls: Callable[[], object]) -> list[float]:
    """The median time of each call in microseconds; the calls take turns."""
    numbers = [max(1, int(_ROUND / timeit.timeit(call, number=5) * 5)) for call in calls]
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(rounds):
        for call, number, found in zip(calls, numbers, times, strict=True):
            found.append(timeit.timeit(call, number=number) / number * 1e6)
    return [median(found) for found in times]


def row(label: str, message: Generated, rounds: int) -> list[object]:
    """One message's line of the table."""
    payload = encode(message)
    cls = type(message)
    stock = cls.decode(payload)  # with its length fields set, as lcm-gen's encoder needs them
    own = decode(cls, payload)
    ours, of_lists, theirs, ours_back, theirs_back = measure(
        rounds,
        lambda: encode(own),
        lambda: encode(message),
        stock.encode,
        lambda: decode(cls, payload),
        lambda: cls.decode(payload),
    )
    assert stock.encode() == payload, type_name(message)
    rates = [ours, of_lists, theirs, theirs / ours, ours_back, theirs_back, theirs_back / ours_back]
    return [label, len(payload), *rates]


def template_row(rounds: int) -> list[object]:
    """An odometry of new numbers: made, and filled into a template."""
    pose, twist = (1.5, 2.0, 0.0, 0.0, 0.0, 0.6, 0.8), (0.5, 0.0, 0.0, 0.0, 0.0, 0.3)
    template = PayloadTemplate(
        _odometry((0,) * 7, (0,) * 6), "header.stamp", "pose.pose", "twist.twist"
    )
    filled, made = measure(
        rounds, lambda: template.fill((3, 5), pose, twist), lambda: encode(_odometry(pose, twist))
    )
    assert template.fill((3, 5), pose, twist) == encode(_odometry(pose, twist))
    return ["Odometry", filled, made, made / filled]


def _odometry(place: Sequence[float], speed: Sequence[float]) -> Odometry:
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nsec = 3, 5
    message.header.frame_id, message.child_frame_id = "odom", "base_link"
    pose, twist = message.pose.pose, message.twist.twist
    position, turned, linear, angular = pose.position, pose.orientation, twist.linear, twist.angular
    position.x, position.y, position.z, turned.x, turned.y, turned.z, turned.w = place
    linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = speed
    return message


def text_row(label: str, message: Generated, rounds: int) -> list[object]:
    """One message's line of the table of texts."""
    received = decode(type(message), encode(message))
    plain = to_plain(received)
    ours, theirs = measure(
        rounds,
        lambda: format_message(received),
        lambda: yaml.dump(plain, Dumper=yaml.CSafeDumper, sort_keys=False),
    )
    return [label, ours, theirs, theirs / ours]


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 25)
    messages = samples()
    show(
        "One message, microseconds",
        [
            "message",
            "bytes",
            "encode",
            "of lists",
            "lcm-gen",
            "ratio",
            "decode",
            "lcm-gen",
            "ratio",
        ],
        [row(label, message, rounds) for label, message in messages.items()],
    )
    show(
        "A message with new numbers, microseconds",
        ["message", "filled", "made", "ratio"],
        [template_row(rounds)],
    )
    for large in ("PointCloud2 1 MB", "OccupancyGrid 200x200", "Image 640x480"):
        del messages[large]  # a million numbers, for which yaml.dump takes minutes
    show(
        "One message as text, microseconds",
        ["message", "echo's", "yaml.dump", "ratio"],
        [text_row(label, message, rounds) for label, message in messages.items()],
    )


if __name__ == "__main__":
    main()
