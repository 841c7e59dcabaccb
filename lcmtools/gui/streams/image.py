"""The stream of an image topic: its newest image, with no more pixels than the page shows."""

import math
import struct
import time
from typing import Annotated, cast

from lcmtools.errors import DecodeError
from lcmtools.formats.typed import Within
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, absence
from lcmtools.gui.streams.base import PageStream, Update, Waiting
from lcmtools.messages.pixels import (
    COLOR_MAPS,
    MOST_PIXELS,
    Kind,
    as_file,
    check_size,
    image_file,
    read_pixels,
)
from lcmtools.messages.registry import type_name
from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools.wire.packet import Packet

_FASTEST = 30e6  # [bytes/s] of one stream's images; larger ones are sent less often
_FEWEST = 1000  # pixels that a page can request
_LOWEST_RATE = 1e-3  # [Hz]
_MOST_NAMED = 3  # topics of images in a hint
TYPES = frozenset({"sensor_msgs/Image", "sensor_msgs/CompressedImage"})
_PNG_HEADER = struct.Struct(">16xIIBB")  # width, height, bits per number, and colour type
_PNG, _JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"


class NewestImage(PageStream):
    """The newest image of ``topic``; of raw ones every n-th pixel, so that ``pixels`` remain.

    ``rate`` is the highest number of images a second.
    """

    period = 0.03
    is_shared = True

    def __init__(
        self,
        source: Source,
        *,
        topic: str,
        pixels: Annotated[float, Within(_FEWEST)] = MOST_PIXELS,
        rate: Annotated[float, Within(_LOWEST_RATE)] = 10.0,
    ) -> None:
        super().__init__(source)
        self._waiting = Waiting()
        self._not_before = 0.0
        self._mistake = ""
        self._pixels = pixels
        self._shortest = 1 / rate  # [s]
        self.follow(topic, self._waiting.add)

    def update(self) -> Update | None:
        """Return the newest image, if it has not been returned yet."""
        if time.monotonic() < self._not_before:
            return None
        packets, count = self._waiting.pop()
        if not packets:
            return None
        (packet,) = packets
        try:
            found = self._read(packet)
        except DecodeError as error:
            self._mistake = str(error)
            return None
        self._mistake = ""
        pause = max(self._shortest, len(found.payload or b"") / _FASTEST)
        self._not_before = time.monotonic() + pause
        about: dict[str, Json] = {"topic": self._topic, "count": count, "bytes": packet.size}
        return Update({**found.data, **about, "time": packet.time / 1e9}, found.payload)

    def problem(self) -> str:
        """Return why there is no image."""
        return self._mistake or absence(self.source, self._topic)

    def _read(self, packet: Packet) -> Update:
        message = self.source.decode(packet)
        if isinstance(message, (Image, CompressedImage)):
            file = as_file(message)
            return _file(file) if file else _raw(cast("Image", message), self._pixels)
        rows = self.source.latest.rows
        named = [row.channel for row in rows if not TYPES.isdisjoint(row.types)]
        hint = f"images are on {', '.join(named[:_MOST_NAMED])}" if named else "no topic has any"
        what = f"{packet.channel} has no images: its messages are {type_name(message)}"
        raise DecodeError(what, hint)


def _raw(message: Image, most: float) -> Update:
    whole = read_pixels(message)
    step = math.ceil(math.sqrt(max(1.0, whole.width * whole.height / most)))
    pixels = whole.every(step)
    return Update(
        {
            "encoding": message.encoding,
            "kind": pixels.format.kind.value,
            "number": pixels.format.number,
            "channels": pixels.format.channels,
            "unit": pixels.format.unit,
            "columns": pixels.width,
            "rows": pixels.height,
            "step": step,
            "width": whole.width,
            "height": whole.height,
            "frame": message.header.frame_id,
        },
        pixels.data,
    )


def _file(message: CompressedImage) -> Update:
    """Return a PNG or JPEG file unchanged: the page decodes it."""
    data = image_file(message)
    about: dict[str, Json] = {"encoding": message.format, "frame": message.header.frame_id}
    if data.startswith(_JPEG):
        return Update({**about, "file": "image/jpeg"}, data)
    if not data.startswith(_PNG) or len(data) < _PNG_HEADER.size:
        raise DecodeError(f"pictures in '{message.format}' are not shown", "known: jpeg, png")
    width, height, bits, color = _PNG_HEADER.unpack_from(data)
    check_size(width, height, "png")
    if (bits, color) == (16, 0):  # the same as in read_file
        depth = {"kind": Kind.DEPTH.value, "number": "H", "channels": "v", "unit": "mm"}
        about = {**about, **depth, "step": 1, "width": width, "height": height}
    return Update({**about, "file": "image/png"}, data)


def color_maps(*_: object) -> Json:
    """Return the colours of depth by name, from near to far."""
    return COLOR_MAPS
