"""The images of a log as PNG or JPEG files, one a message."""

from contextlib import AbstractContextManager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lcmtools.bag.tables import file_name
from lcmtools.clock import split_stamp
from lcmtools.errors import DecodeError, needing_extra
from lcmtools.messages.fields import stamp
from lcmtools.messages.pixels import Kind, image_file
from lcmtools.messages.registry import type_name
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.sensor_msgs import CompressedImage, Image
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:  # an extra
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
        """Return the path of a new file."""
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
