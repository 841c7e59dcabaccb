"""PNG files as bytes, read and written: 8-bit grey and colour, 16-bit grey.

Format: W3C, Portable Network Graphics (third edition), https://www.w3.org/TR/png-3/. Palettes,
interlaced pictures and depths below 8 bits are not read.
"""

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate

from lcmtools.errors import DecodeError

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_HEADER = struct.Struct(">IIBBBBB")
_NONE, _SUB, _UP, _AVERAGE, _PAETH = range(5)
_CHANNELS = {0: 1, 2: 3, 6: 4}  # by colour type: grey; red, green, blue; and alpha
_COLOR_TYPES = {channels: color for color, channels in _CHANNELS.items()}
_KNOWN = ((1, 8), (1, 16), (3, 8), (4, 8))  # channels and bits
_MOST_PIXELS = 1 << 26
_BYTE_BITS = 8


@dataclass(frozen=True, slots=True)
class PngPixels:
    """What is in a PNG file.

    Attributes:
        width: [pixels]
        height: [pixels]
        channels: 1 grey, 3 red, green and blue, 4 with alpha.
        bits: Of a number: 8, or 16 with the most significant byte first.
        rows: The pixels from top to bottom, without gaps.
    """

    width: int
    height: int
    channels: int
    bits: int
    rows: bytes

    @property
    def pixel_bytes(self) -> int:
        """Bytes of a pixel."""
        return self.channels * self.bits // _BYTE_BITS


def encode_png(pixels: PngPixels) -> bytes:
    """A PNG file of some pixels."""
    color = _COLOR_TYPES[pixels.channels]
    header = _HEADER.pack(pixels.width, pixels.height, pixels.bits, color, 0, 0, 0)
    size = pixels.width * pixels.pixel_bytes
    starts = range(0, pixels.height * size, size)
    filtered = b"".join(b"\0" + pixels.rows[start : start + size] for start in starts)
    content = zlib.compress(filtered, 6)
    chunks = ((b"IHDR", header), (b"IDAT", content), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(name, content) for name, content in chunks)


def decode_png(data: bytes) -> PngPixels:
    """The pixels in a PNG file.

    Raises:
        DecodeError: It is no PNG file, broken, or of a kind that is not read.
    """
    try:
        return _decode(data)
    except (zlib.error, struct.error, ValueError) as error:
        raise DecodeError(f"broken PNG picture: {error}") from None


def _chunk(name: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(content, zlib.crc32(name))
    return b"".join((struct.pack(">I", len(content)), name, content, struct.pack(">I", checksum)))


def _decode(data: bytes) -> PngPixels:
    chunks = _chunks(data)
    width, height, bits, color, *methods = _HEADER.unpack(chunks.get(b"IHDR", b""))
    empty = PngPixels(width, height, _CHANNELS.get(color, 0), bits, b"")
    if (empty.channels, bits) not in _KNOWN or any(methods):
        raise ValueError("a palette, interlace, or bits other than 8, or 16 of grey, are not read")
    if not 0 < width * height <= _MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels")
    row_bytes = width * empty.pixel_bytes
    filtered = _inflate(chunks.get(b"IDAT", b""), height * (row_bytes + 1))
    rows = b"".join(_unfiltered(filtered, row_bytes, empty.pixel_bytes))
    return PngPixels(width, height, empty.channels, bits, rows)


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """The chunks by name; the parts of the picture joined."""
    if not data.startswith(_SIGNATURE):
        raise ValueError("it has no PNG signature")
    chunks: dict[bytes, list[bytes]] = {}
    at = len(_SIGNATURE)
    while b"IEND" not in chunks:
        size, name = struct.unpack_from(">I4s", data, at)
        content = data[at + 8 : at + 8 + size]
        (checksum,) = struct.unpack_from(">I", data, at + 8 + size)
        if checksum != zlib.crc32(content, zlib.crc32(name)):
            raise ValueError(f"wrong checksum of {name!r}")
        chunks.setdefault(name, []).append(content)
        at += 12 + size
    return {name: b"".join(parts) for name, parts in chunks.items()}


def _inflate(data: bytes, size: int) -> bytes:
    """So many bytes, and never more, however much the data would make."""
    content = zlib.decompressobj().decompress(data, size)
    if len(content) != size:
        raise ValueError(f"{len(content)} bytes of pixels instead of {size}")
    return content


def _unfiltered(filtered: bytes, row_bytes: int, pixel: int) -> Iterator[bytes]:
    """Undo each row's filter; ``pixel`` is the bytes of one."""
    above = bytes(row_bytes)
    for start in range(0, len(filtered), row_bytes + 1):
        row = filtered[start + 1 : start + 1 + row_bytes]
        above = _unfilter(filtered[start], row, above, pixel)
        yield above


def _unfilter(kind: int, row: bytes, above: bytes, pixel: int) -> bytes:
    if kind == _NONE:
        return row
    if kind == _SUB:
        return _add_to_the_left(row, pixel)
    if kind == _UP:
        return _add_bytes(row, above)
    if kind == _AVERAGE:
        return _undo_average(row, above, pixel)
    if kind == _PAETH:
        return _undo_paeth(row, above, pixel)
    raise ValueError(f"unknown filter {kind}")


def _add_bytes(one: bytes, other: bytes) -> bytes:
    """The sums of two rows' bytes, each modulo 256.

    All at once, as two large numbers: the upper bit of each byte is left out of the sum, so that
    no carry gets into the next one, and added without carry (H. Warren, Hacker's Delight, 2-18).
    """
    size = len(one)
    low = int.from_bytes(b"\x7f" * size, "little")
    a, b = int.from_bytes(one, "little"), int.from_bytes(other, "little")
    total = ((a & low) + (b & low)) ^ ((a ^ b) & ~low & ((1 << size * _BYTE_BITS) - 1))
    return total.to_bytes(size, "little")


def _add_to_the_left(row: bytes, pixel: int) -> bytes:
    done = bytearray(len(row))
    for lane in range(pixel):
        done[lane::pixel] = bytes(value & 255 for value in accumulate(row[lane::pixel]))
    return bytes(done)


def _undo_average(row: bytes, above: bytes, pixel: int) -> bytes:
    done = bytearray(pixel)  # zeros to the left
    for at, (value, upper) in enumerate(zip(row, above, strict=True)):
        done.append((value + (done[at] + upper) // 2) & 255)
    return bytes(done[pixel:])


def _undo_paeth(row: bytes, above: bytes, pixel: int) -> bytes:
    """Add whichever neighbour is nearest to left + above - corner, in this order."""
    done = bytearray(pixel)
    corners = bytes(pixel) + above
    for at, (value, upper, corner) in enumerate(zip(row, above, corners, strict=False)):
        left = done[at]
        to_left, to_upper = abs(upper - corner), abs(left - corner)
        to_corner = abs(left + upper - 2 * corner)
        if to_left <= to_upper and to_left <= to_corner:
            guess = left
        else:
            guess = upper if to_upper <= to_corner else corner
        done.append((value + guess) & 255)
    return bytes(done[pixel:])
