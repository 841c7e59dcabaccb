"""PNG files of the two kinds that cameras send: 16-bit grey and 8-bit red, green, blue.

Bytes and arrays only. Format: W3C, Portable Network Graphics (third edition), https://www.w3.org/TR/png-3/.
Rows are written with the filter "up" (difference to the row above), which numpy does for a whole
picture at once. The reader takes all filters, but no palettes, alpha, interlace or other depths.
"""

import struct
import zlib

import numpy as np
import numpy.typing as npt

from lcmtools.errors import DecodeError

Picture = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]

FASTEST = 1
"""zlib's level; higher ones take several times as long for a few percent."""

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_HEADER = struct.Struct(">IIBBBBB")
_GREY, _RGB = (16, 0), (8, 2)  # bits of a sample, colour type
_NONE, _SUB, _UP, _AVERAGE, _PAETH = range(5)
_MOST_PIXELS = 1 << 26


def encode_png(picture: Picture, level: int = FASTEST) -> bytes:
    """A PNG file of a picture.

    Args:
        picture: (height, width) uint16, or (height, width, 3) uint8.
        level: 0 (not compressed) to 9 (slowest).

    Raises:
        ValueError: It is neither.
    """
    bits, color = _kind(picture)
    height, width = picture.shape[:2]
    samples = np.ascontiguousarray(picture, ">u2" if bits == 16 else np.uint8)  # noqa: PLR2004
    rows = samples.view(np.uint8).reshape(height, -1)
    filtered = np.empty((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 0] = _UP
    filtered[:1, 1:] = rows[:1]
    np.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    header = _HEADER.pack(width, height, bits, color, 0, 0, 0)
    return b"".join(
        (
            _SIGNATURE,
            _chunk(b"IHDR", header),
            _chunk(b"IDAT", zlib.compress(filtered.data, level)),
            _chunk(b"IEND", b""),
        )
    )


def decode_png(data: bytes) -> Picture:
    """The picture in a PNG file: (height, width) uint16 or (height, width, 3) uint8.

    Raises:
        DecodeError: It is no PNG file, broken, or of a kind that this module does not read.
    """
    try:
        return _decode(data)
    except (zlib.error, struct.error, ValueError) as error:
        raise DecodeError(f"broken PNG picture: {error}") from None


def _kind(picture: Picture) -> tuple[int, int]:
    if picture.dtype == np.uint16 and picture.ndim == 2:  # noqa: PLR2004
        return _GREY
    if picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3:  # noqa: PLR2004
        return _RGB
    raise ValueError(f"no picture: {picture.dtype} of shape {picture.shape}")


def _chunk(name: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(content, zlib.crc32(name))
    return b"".join((struct.pack(">I", len(content)), name, content, struct.pack(">I", checksum)))


def _decode(data: bytes) -> Picture:
    chunks = _chunks(data)
    width, height, bits, color, *methods = _HEADER.unpack(chunks.get(b"IHDR", b""))
    if (bits, color) not in (_GREY, _RGB) or any(methods):
        raise ValueError("only 16-bit grey and 8-bit RGB without interlace are read")
    if not 0 < width * height <= _MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels")
    pixel = 2 if (bits, color) == _GREY else 3
    rows = _inflate(chunks.get(b"IDAT", b""), height * (1 + width * pixel)).reshape(height, -1)
    samples = _unfilter(rows, pixel)
    if pixel == 2:  # noqa: PLR2004
        return samples.view(">u2").astype(np.uint16)
    return samples.reshape(height, width, 3)


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """The chunks by name; the parts of the picture joined."""
    if data[: len(_SIGNATURE)] != _SIGNATURE:
        raise ValueError("no PNG signature")
    chunks: dict[bytes, list[bytes]] = {}
    at = len(_SIGNATURE)
    while b"IEND" not in chunks:
        (size,) = struct.unpack_from(">I", data, at)
        name, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        (checksum,) = struct.unpack_from(">I", data, at + 8 + size)
        if checksum != zlib.crc32(content, zlib.crc32(name)):
            raise ValueError(f"wrong checksum of {name!r}")
        chunks.setdefault(name, []).append(content)
        at += 12 + size
    return {name: b"".join(parts) for name, parts in chunks.items()}


def _inflate(data: bytes, size: int) -> npt.NDArray[np.uint8]:
    """So many bytes, and never more, however much the data would make."""
    content = zlib.decompressobj().decompress(data, size)
    if len(content) != size:
        raise ValueError(f"{len(content)} bytes of pixels instead of {size}")
    return np.frombuffer(content, np.uint8)


def _unfilter(rows: npt.NDArray[np.uint8], pixel: int) -> npt.NDArray[np.uint8]:
    """Undo each row's filter; ``pixel`` is the bytes of one."""
    if (rows[:, 0] == _UP).all():
        return np.add.accumulate(rows[:, 1:], axis=0, dtype=np.uint8)
    above = np.zeros(rows.shape[1] - 1, np.uint8)
    result = np.empty((len(rows), len(above)), np.uint8)
    for number, row in enumerate(rows):
        above = result[number] = _unfilter_row(int(row[0]), row[1:], above, pixel)
    return result


def _unfilter_row(
    kind: int, row: npt.NDArray[np.uint8], above: npt.NDArray[np.uint8], pixel: int
) -> npt.NDArray[np.uint8]:
    if kind == _NONE:
        return row
    if kind == _SUB:
        steps = row.reshape(-1, pixel)
        return np.add.accumulate(steps, axis=0, dtype=np.uint8).reshape(-1)
    if kind == _UP:
        return row + above
    if kind not in (_AVERAGE, _PAETH):
        raise ValueError(f"unknown filter {kind}")
    guess = _average if kind == _AVERAGE else _paeth
    done, upper = bytearray(pixel), bytes(pixel) + above.tobytes()  # zeros to the left
    for at, value in enumerate(row.tolist()):
        done.append((value + guess(done[at], upper[at + pixel], upper[at])) & 255)
    return np.frombuffer(bytes(done[pixel:]), np.uint8)


def _average(left: int, above: int, _corner: int) -> int:
    return (left + above) // 2


def _paeth(left: int, above: int, corner: int) -> int:
    """Whichever neighbour is nearest to left + above - corner, in this order."""
    guess = left + above - corner
    return min((left, above, corner), key=lambda neighbour: abs(guess - neighbour))
