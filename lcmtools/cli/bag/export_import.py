"""``lcmtools bag export`` and ``import``."""

from pathlib import Path

import click

from lcmtools.bag import edits, stamps
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.export import FORMATS, export, format_of
from lcmtools.bag.latched import part_of
from lcmtools.bag.ros_bags import Compression
from lcmtools.bag.ros_import import RosImport
from lcmtools.bag.summary import known_nodes
from lcmtools.bag.text_import import SUFFIXES, text_packets
from lcmtools.bag.times import LogTime
from lcmtools.cli.bag.common import (
    exclude_option,
    made_options,
    places,
    stamp_option,
    topic_choice,
    topics_option,
    values_options,
    window_options,
    write,
)
from lcmtools.cli.bus import notify
from lcmtools.cli.declare import examples, option, subcommand
from lcmtools.cli.output import results_beside, write_note, write_result
from lcmtools.errors import UsageError
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.text_table import plural
from lcmtools.wire.packet import Packet


@subcommand("export", made_options)
@examples(
    "bag export ride.lcmlog ride.mcap",
    "bag export ride.lcmlog odometry.csv -t /husky0/odometry",
    "bag export ride.lcmlog scans.npz -t '/*/scan' -s 10s -e end-1m",
    "bag export ride.lcmlog ride_bag --format ros2",
    "bag export ride.lcmlog pictures --format png -t /camera/image",
)
@places
@option(
    "--format", "format_", type=click.Choice(FORMATS), help="The format (else by OUT's suffix)."
)
@topics_option
@exclude_option
@window_options
@stamp_option
@option(
    "--compress",
    type=click.Choice(["zstd", "lz4", "none"]),
    default="zstd",
    help="Compression of MCAP chunks.",
)
def export_(
    source: str,
    target: str,
    *,
    format_: str | None,
    wanted: tuple[str, ...],
    excluded: tuple[str, ...],
    start: LogTime | None,
    end: LogTime | None,
    by_stamp: bool,
    compress: Compression,
    force: bool,
    as_json: bool,
) -> int:
    """Write a log in another format.

    OUT's suffix gives the format: comma-separated values (.csv), JSON lines (.jsonl), NumPy arrays
    (.npz), Parquet (.parquet), MCAP with ROS's schemas (.mcap) or a ROS 1 bag (.bag). With --format
    csv, parquet or ros2 and no suffix, OUT is a folder; png and jpeg write each image to a file in
    it. Hidden topics are left out, unless -t names them. The exit code is 1 if messages cannot be
    written, 2 if none can.
    """
    meant = format_of(Path(target), format_)
    with stamps.by_stamp([source], wanted=by_stamp) as (path,), LogFile(path) as log:
        _, found = part_of(log, start, end, notify=notify)
        found = edits.chosen(found, topic_choice(log, wanted, excluded))
        found = found if wanted else edits.visible(found)
        decoder = Decoder(known_nodes(log).types_of)
        done = export(
            found,
            decoder,
            Path(target),
            meant,
            compression=compress,
            recorded=log.index.types,
            force=force,
        )
        if damage := log.damage():
            done.add_omission("damage", damage)
    for text in done.left_out.values():
        write_note(text)
    record = {"path": target, "messages": done.messages, "left_out": [*done.left_out.values()]}
    with results_beside(target):
        write_result(record, [f"{target}: {plural(done.messages, 'message')}"], as_json=as_json)
    return 1 if done.left_out else 0


@subcommand("import", made_options)
@examples(
    "bag import ride.bag ride.lcmlog",
    "bag import rosbag2_folder ride.lcmlog",
    "bag import ride.mcap scans.lcmlog -t '/*/scan'",
    "bag import ride.jsonl ride.lcmlog",
    "bag import odometry.csv ride.lcmlog --type nav_msgs/Odometry --as /odometry",
)
@places
@values_options
@topics_option
@exclude_option
def import_(
    source: str,
    target: str,
    *,
    type_: str | None,
    topic: str | None,
    wanted: tuple[str, ...],
    excluded: tuple[str, ...],
    force: bool,
    as_json: bool,
) -> int:
    """Convert a ROS 1 or ROS 2 bag, an MCAP file, JSON lines or values to a log.

    JSON lines (.jsonl) and comma-separated values (.csv) are those of bag export.
    An unknown type is translated from the bag's own definition, which the log keeps. The exit code
    is 1 if messages are left out or numbers changed, 2 if nothing is imported.
    """
    if Path(source).suffix in SUFFIXES:
        left_out: list[str] = []
        found_lines = text_packets(Path(source), type_, topic, left_out.append)
        lines = edits.chosen(found_lines, TopicChoice(wanted, excluded))
        write(target, lines, force=force, as_json=as_json, more=lambda: {"left_out": left_out})
        for text in left_out:
            write_note(text)
        return 1 if left_out else 0
    if type_ or topic:
        raise UsageError("--type and --as are for .csv and .jsonl", "leave them out")
    reading = RosImport()
    found = reading.read(Path(source), TopicChoice(wanted, excluded))
    packets = (Packet(one.topic, encode(one.message), one.time) for one in found)
    report = reading.report
    write(
        target,
        packets,
        force=force,
        as_json=as_json,
        more=report.to_json,
        types=reading.types.values(),
        nodes=reading.nodes(),
    )
    for text in report.to_lines():
        write_note(text)
    return 0 if report.is_complete else 1
