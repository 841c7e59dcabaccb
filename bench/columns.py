"""Speed of a topic's messages as arrays: ``bag/columns`` beside decoding message by message.

The anchors decode each message, by lcmtools and by lcm-gen's own Python, take the numbers of its
fields, and make a numpy array of each field in the end. Each figure is the best of alternating
rounds, in microseconds for one message; the ratios are the anchors' times by ours.
"""

import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from codec import Generated, samples
from common import rounds_asked, show

from lcmtools.bag.columns import table
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.path import Path, parse_path

_SHOWN = ("Twist", "Odometry", "JointState 12", "LaserScan 360")
_MESSAGES = 5000


def one_by_one(cls: type[Generated], payloads: Sequence[bytes]) -> Mapping[str, object]:
    """Return the columns of messages that lcmtools decodes one by one."""
    return _collected(cls, payloads, lambda payload: decode(cls, payload))


def by_lcm_gen(cls: type[Generated], payloads: Sequence[bytes]) -> Mapping[str, object]:
    """Return the columns of messages that lcm-gen's Python decodes one by one."""
    return _collected(cls, payloads, cls.decode)


def _collected(
    cls: type[Generated], payloads: Sequence[bytes], decoded: Callable[[bytes], object]
) -> Mapping[str, object]:
    paths = [(name, parse_path(name)) for name in table(cls, payloads[:1]).columns]
    values: dict[str, list[object]] = {name: [] for name, _ in paths}
    for payload in payloads:
        message = decoded(payload)
        for name, path in paths:
            values[name].append(_value(message, path))
    return {name: np.array(column) for name, column in values.items()}


def _value(message: object, path: Path) -> object:
    for step in path.steps:
        message = getattr(message, str(step))
    return message


def main() -> None:
    """Measure, and print the table."""
    rounds, rows = rounds_asked(__doc__, 5), []
    for name, message in samples().items():
        if name not in _SHOWN:
            continue
        cls, payloads = type(message), [encode(message)] * _MESSAGES
        times = {
            way: [_timed(way, cls, payloads) for _ in range(rounds)]
            for way in (table, one_by_one, by_lcm_gen)
        }
        ours, *anchors = (min(found) / _MESSAGES * 1e6 for found in times.values())
        ratios = [f"{anchor / ours:.1f}" for anchor in anchors]
        rows.append([name, *(f"{one:.2f}" for one in (ours, *anchors)), *ratios])
    heading = ["message", "columns [us]", "one by one [us]", "lcm-gen [us]", "ratio", "of lcm-gen"]
    show("Messages as arrays", heading, rows)


def _timed(way: Callable[..., object], cls: type[Generated], payloads: Sequence[bytes]) -> float:
    begin = time.perf_counter()
    way(cls, payloads)
    return time.perf_counter() - begin


if __name__ == "__main__":
    main()
