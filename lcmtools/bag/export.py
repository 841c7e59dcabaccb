"""Exporting a log: choosing the target for a format, and writing the messages to it."""

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from lcmtools.bag.output import output_beside
from lcmtools.bag.ros_bags import Compression, McapFile, RosBag, database_errors
from lcmtools.bag.ros_types import NO_TYPES, RecordedTypes
from lcmtools.bag.tables import CsvFiles, JsonLines, NumpyFile, OnOmission, ParquetFiles, file_name
from lcmtools.clock import split_stamp
from lcmtools.errors import DecodeError, InvalidFile, UsageError, needing_extra
from lcmtools.folders import is_stream
from lcmtools.messages.fields import stamp
from lcmtools.messages.pixels import Kind, image_file
from lcmtools.messages.registry import type_name
from lcmtools.names import did_you_mean
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    from lcmtools.messages.pictures import Picture


_MAGIC = {"png": b"\x89PNG", "jpeg": b"\xff\xd8\xff"}
_DEEPEST = (1 << 16) - 1  # [mm] what a PNG file holds


class PictureFiles(AbstractContextManager["PictureFiles"]):
    """A folder with a folder for each topic, whose files are named by the time of their message.

    That is its stamp, else that of recording: ``camera_image/1795384180.123456789.png``. Images
    that have the wanted format are copied. Depth is in PNG only, 16-bit millimetres.

    Raises:
        MissingExtra: Pillow is missing.
    """

    def __init__(self, folder: Path, form: str) -> None:
        with needing_extra("view", "pictures need"):
            import PIL.Image  # noqa: F401 - before anything is read
        self._folder, self._form = folder, form
        self._suffix = {"jpeg": ".jpg"}.get(form, f".{form}")
        folder.mkdir()

    def __exit__(self, *_: object) -> None:
        """Do nothing: each file is complete."""

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message's file; DecodeError if it is no image, or cannot be in this format."""
        message = decoder.decode(packet)
        if not isinstance(message, (Image, CompressedImage)):
            raise DecodeError(f"{type_name(message)} is no image")
        path = self._path(packet, stamp(message) or packet.time)
        content = image_file(message) if isinstance(message, CompressedImage) else b""
        if content.startswith(_MAGIC[self._form]):
            path.write_bytes(content)
            return
        from lcmtools.messages.pictures import read_picture

        _image(read_picture(message), self._form).save(path, self._form.upper())

    def _path(self, packet: Packet, time: int) -> Path:
        folder = self._folder / file_name(packet.channel)
        folder.mkdir(exist_ok=True)
        seconds, nanoseconds = split_stamp(time)
        name = f"{seconds}.{nanoseconds:09}"
        names = (name if number == 1 else f"{name}_{number}" for number in count(1))
        paths = (folder / f"{one}{self._suffix}" for one in names)
        return next(one for one in paths if not one.exists())


def _image(picture: "Picture", form: str) -> Any:  # noqa: ANN401 - of Pillow
    """Return what is written: depth and 16-bit grey as 16-bit numbers."""
    if picture.image.mode in ("RGB", "L"):
        return picture.image
    if form != "png":
        what = "depth" if picture.kind is Kind.DEPTH else "grey of 16 bits"
        raise DecodeError(f"{what} cannot be in a JPEG file; use png")
    import PIL.Image

    values = b"".join(min(one, _DEEPEST).to_bytes(2, "little") for one in picture.values())
    return PIL.Image.frombytes("I;16", picture.image.size, values)


SUFFIXES = {
    ".csv": "csv",
    ".jsonl": "jsonl",
    ".ndjson": "jsonl",
    ".npz": "npz",
    ".parquet": "parquet",
    ".mcap": "mcap",
    ".bag": "ros1",
}
FORMATS = ("csv", "jsonl", "npz", "parquet", "mcap", "mcap-ros1", "ros1", "ros2", "png", "jpeg")
_TEXTS = ("csv", "jsonl")
_FOLDERS = {"ros2": "a bag of ROS 2", "png": "what has a file for each image"}
_FOLDERS["jpeg"] = _FOLDERS["png"]


@dataclass(slots=True)
class Exported:
    """The result of an export."""

    messages: int = 0  # number of exported messages
    # Sentences on what was left out, by reason.
    left_out: dict[str, str] = field(default_factory=dict)

    def add_omission(self, reason: str, text: str) -> None:
        """Note what is left out, once per reason."""
        self.left_out.setdefault(reason, text)


class _Target(Protocol):
    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message; raises DecodeError."""


def format_of(target: Path, named: str | None) -> str:
    """Return the format for a name or the target's suffix; UsageError if neither is one."""
    if named is not None:
        if named not in FORMATS:
            hint = did_you_mean(named, FORMATS) or f"formats: {', '.join(FORMATS)}"
            raise UsageError(f"unknown format '{named}'", hint)
        return named
    if target.suffix not in SUFFIXES:
        hint = f"use a suffix ({', '.join(SUFFIXES)}), or add --format"
        raise UsageError(f"the format of {target} is unknown", hint)
    return SUFFIXES[target.suffix]


def export(  # noqa: PLR0913 - each is a separate option
    packets: Iterable[Packet],
    decoder: Decoder,
    target: Path,
    format_: str,
    *,
    compression: Compression = "zstd",
    recorded: RecordedTypes = NO_TYPES,
    force: bool = False,
) -> Exported:
    """Write messages to a file or folder in another format, one of ``FORMATS``.

    CSV and Parquet have a file for each topic: a target without a suffix is a folder for these;
    pictures, png and jpeg, have a folder with a file for each image. The
    target appears when it is complete. ``compression`` is for MCAP; ``recorded`` are the types that
    the log keeps.

    Raises:
        MissingExtra: A library is missing.
        LcmtoolsError: The target exists, and not ``force``; or it cannot be written.
        InvalidFile: Nothing could be exported.
    """
    done = Exported()
    if format_ in _FOLDERS and is_stream(target):
        what = f"{_FOLDERS[format_]} is a folder, which {target} cannot be"
        raise UsageError(what, "name a folder")
    with (
        output_beside(target, force=force, binary=format_ not in _TEXTS) as beside,
        database_errors(),
        _open(beside, format_, compression, recorded, done.add_omission) as file,
    ):
        for packet in packets:
            _add(file, packet, decoder, done)
        if not done.messages:
            why = next(iter(done.left_out.values()), "no messages are selected")
            raise InvalidFile(f"nothing is written to {target}", why)
    return done


def _add(file: _Target, packet: Packet, decoder: Decoder, done: Exported) -> None:
    try:
        file.add(packet, decoder)
    except DecodeError as error:
        what = f"messages on {packet.channel} are left out: {error}"
        done.add_omission(f"{packet.channel} {error}", what)
    else:
        done.messages += 1


def _open(
    path: Path,
    format_: str,
    compression: Compression,
    recorded: RecordedTypes,
    on_omission: OnOmission,
) -> AbstractContextManager[_Target]:
    makers: dict[str, Callable[[], AbstractContextManager[_Target]]] = {
        "csv": lambda: CsvFiles(path),
        "jsonl": lambda: JsonLines(path),
        "npz": lambda: NumpyFile(path, on_omission),
        "parquet": lambda: ParquetFiles(path, on_omission),
        "mcap": lambda: McapFile(path, "cdr", compression, recorded),
        "mcap-ros1": lambda: McapFile(path, "ros1", compression, recorded),
        "ros1": lambda: RosBag(path, 1, recorded=recorded),
        "ros2": lambda: RosBag(path, 2, recorded=recorded),
        "png": lambda: PictureFiles(path, "png"),
        "jpeg": lambda: PictureFiles(path, "jpeg"),
    }
    return makers[format_]()
