"""``lcmtools tf tree`` and ``tf echo``."""

import math
from collections.abc import Iterator, Sequence
from itertools import islice

from lcmtools.cli.bus import notify, notify_damage, open_monitor
from lcmtools.cli.declare import (
    argument,
    duration,
    examples,
    flag,
    option,
    rate,
    subcommand,
    whole_number,
)
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.options import bus_choice, json_option, looking_options
from lcmtools.cli.output import write_data, write_lines, write_result
from lcmtools.errors import LcmtoolsError, NothingReceived
from lcmtools.formats.strict_json import write_json
from lcmtools.observe.frames.following import FollowedFrames
from lcmtools.observe.frames.frames import Place, Transform
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.text_table import text_table

_LISTENED = 2.0  # [s] for the tree of a bus
_LONG = 1e6  # [s] between two looks at a tree that is shown once
_PATIENCE = 2.0  # [s] until the user is told that a frame is missing


@subcommand("tree", json_option, looking_options)
@examples("tf tree", "tf tree -b ride.lcmlog", "tf tree --ns /husky0 --wait 5s")
@option("--wait", type=duration, help="Listen for this long (else 2s).")
def tree(*, wait: float | None, as_json: bool) -> None:
    """Show the tree of coordinate frames, who publishes each, and how often.

    The frames are those of all topics of tf2_msgs/TFMessage; each namespace has a tree of its own.
    """
    with open_monitor("tf", whole=True) as monitor:
        frames = FollowedFrames(monitor, bus_choice().names.namespace, notify)
        (now,) = [*frames.follow(_LONG, wait or _LISTENED)][-1:]
        names = SenderNames()
        trees = {name: [*one.places()] for name, one in sorted(frames.trees.all().items())}
        links = [place.link for places in trees.values() for place in places if place.link]
        names.update([link.sender for link in links], monitor.graph().nodes)
        records = [
            _to_json(name, place, now, names) for name, places in trees.items() for place in places
        ]
        notify_damage(monitor)
    rows = [_row(one) for one in records]
    head = [("FRAME", "RATE", "AGE", "TOPIC", "PUBLISHER", "")] if rows else []
    none = f"no transforms on {monitor.url}: no topic of tf2_msgs/TFMessage has a message"
    write_result(records, text_table([*head, *rows]), as_json=as_json, none=none)


def _to_json(tree_: str, place: Place, now: int, names: SenderNames) -> dict[str, object]:
    link = place.link
    faults = [f"also in {one}" for one in link.others] if link else []
    faults += ["in a loop"] if place.is_looped else []
    return {
        "namespace": tree_,
        "frame": place.frame,
        "depth": place.depth,
        "parent": link.parent if link else None,
        "topic": link.topic if link else None,
        "static": link.is_static if link else None,
        "publisher": names.name(link.sender) if link else None,
        "rate": link.rate if link else None,
        "age": max(0.0, (now - link.last_time) / 1e9) if link else None,
        "faults": faults,
    }


def _row(record: dict[str, object]) -> Sequence[str]:
    name = f"{'  ' * int(str(record['depth']))}{record['frame']}"
    if record["parent"] is None:
        return name, "", "", "", "", ""
    hertz = "static" if record["static"] else "-"
    if record["rate"] is not None and not record["static"]:
        hertz = f"{record['rate']:.1f} Hz"
    faults = record["faults"]
    return (
        name,
        hertz,
        f"{record['age']:.1f} s",
        str(record["topic"]),
        str(record["publisher"]),
        "; ".join(faults) if isinstance(faults, list) else "",
    )


@subcommand("echo", json_option, looking_options)
@examples(
    "tf echo odom base_link",
    "tf echo map laser -n 1 --timeout 5s",
    "tf echo odom base_link -b ride.lcmlog -r 10 --json",
)
@argument("source", metavar="SOURCE")
@argument("target", metavar="TARGET")
@option("-r", "--rate", "hertz", type=rate, default=1.0, help="Print at this rate [Hz] (else 1).")
@option("-n", "count", metavar="N", type=whole_number(1), help="Stop after N transforms.")
@flag("-1", "--once", help="Stop after one.")
@option("--timeout", type=duration, help="Exit with code 4 if none can be computed in time.")
def echo(
    source: str,
    target: str,
    *,
    hertz: float,
    count: int | None,
    once: bool,
    timeout: float | None,
    as_json: bool,
) -> None:
    """Print the pose of the frame TARGET in the frame SOURCE, as tf2_echo does.

    It is computed from the latest transforms of all frames between them. A log is read at once, by
    its times.
    """
    source, target = source.lstrip("/"), target.lstrip("/")
    with open_monitor("tf", whole=True) as monitor:
        end_with_reader()
        frames = FollowedFrames(monitor, bus_choice().names.namespace, notify)
        found = _poses(frames, (source, target), 1 / hertz, timeout)
        for now, pose, stamp in islice(found, 1 if once else count):
            if as_json:
                write_data(write_json(_pose_json(now, pose, stamp)))
            else:
                write_lines(_pose_rows(pose, stamp or now))


def _poses(
    frames: FollowedFrames, pair: tuple[str, str], period: float, timeout: float | None
) -> Iterator[tuple[int, Transform, int]]:
    """Yield times, poses, and the times of these; tell once what is missing."""
    begin, missing, is_found, is_told = 0, LcmtoolsError("there are no transforms"), False, False
    for now in frames.follow(period):
        begin = begin or now
        try:
            pose, stamp = frames.trees.between(*pair)
        except LcmtoolsError as error:
            missing = error
            waited = (now - begin) / 1e9
            if timeout is not None and waited >= timeout and not is_found:
                raise NothingReceived(error.what, error.hint) from None
            if waited >= _PATIENCE and not (is_found or is_told):
                is_told = True
                notify(str(error))
            continue
        is_found = True
        yield now, pose, stamp
    if not is_found:
        raise missing


def _pose_json(now: int, pose: Transform, stamp: int) -> dict[str, object]:
    names = ("translation", "rotation", "rpy")
    values = map(list, (*pose, pose.angles))
    return {"time": now, "stamp": stamp or None, **dict(zip(names, values, strict=True))}


def _pose_rows(pose: Transform, stamp: int) -> list[str]:
    def text(numbers: Sequence[float]) -> str:
        return f"[{', '.join(f'{number + 0.0:.3f}' for number in numbers)}]"

    degrees = [math.degrees(angle) for angle in pose.angles]
    return [
        f"At time {stamp // 10**9}.{stamp % 10**9:09}",
        f"- Translation: {text(pose.translation)}",
        f"- Rotation: in Quaternion (xyzw) {text(pose.rotation)}",
        f"            in RPY (radian) {text(pose.angles)}",
        f"            in RPY (degree) {text(degrees)}",
    ]
