"""Compressed logs: frames one after another, each with whole events.

Sans-I/O. If a log was cut off, the part after its last whole frame is read as far as possible. The
libraries belong to the extra ``bag``, and are imported when needed.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, Literal

from lcmtools.errors import needing_extra

Compression = Literal["zstd", "lz4"]
SUFFIXES: dict[Compression, str] = {"zstd": ".zst", "lz4": ".lz4"}
_MAGIC: dict[Compression, bytes] = {"zstd": b"\x28\xb5\x2f\xfd", "lz4": b"\x04\x22\x4d\x18"}

_PIECE = 1 << 20  # bytes


def named_compression(path: Path) -> Compression | None:
    """Return the compression that a file's name ends with; None for none."""
    return next((kind for kind, suffix in SUFFIXES.items() if path.suffix == suffix), None)


def compression_of(head: bytes) -> Compression | None:
    """Return the compression of a file that begins with ``head``; None for none."""
    return next((kind for kind, magic in _MAGIC.items() if head.startswith(magic)), None)


def compressor(kind: Compression) -> Callable[[bytes], bytes]:
    """Return a function that compresses bytes into one frame.

    Raises:
        MissingExtra: The library is missing.
    """
    library = _library(kind)
    if kind == "zstd":
        return library.ZstdCompressor().compress  # type: ignore[no-any-return]
    return library.compress  # type: ignore[no-any-return]


def decompressed(kind: Compression | Literal["bz2"], file: BinaryIO) -> Iterator[bytes]:
    """Yield the content of the frames in a file up to the first damage, in pieces.

    128 kB may contain 4 GB.

    Raises:
        MissingExtra: The library is missing.
    """
    if kind == "bz2":  # in ROS bags
        with suppress(OSError):
            yield from _pieces(import_module("bz2").BZ2Decompressor, file)
        return
    library = _library(kind)
    if kind == "zstd":
        reader = library.ZstdDecompressor().stream_reader(file, read_across_frames=True)
        with suppress(library.ZstdError):
            yield from iter(lambda: reader.read1(_PIECE), b"")
    else:
        with suppress(RuntimeError):
            yield from _pieces(library.LZ4FrameDecompressor, file)


def decompressed_bytes(kind: Compression | Literal["bz2"], data: bytes, most: int) -> bytes:
    """Return the content of frames; ValueError if it has more than ``most`` bytes."""
    plain = BytesIO()
    for piece in decompressed(kind, BytesIO(data)):
        if plain.write(piece) and plain.tell() > most:
            raise ValueError(f"its content has more than {most} bytes")
    return plain.getvalue()


def _pieces(make: Callable[[], Any], file: BinaryIO) -> Iterator[bytes]:
    frame, rest = make(), b""
    while rest := rest or file.read(_PIECE):
        if piece := frame.decompress(rest, _PIECE):
            yield piece
        while not (frame.eof or frame.needs_input):
            yield frame.decompress(b"", _PIECE)
        rest, frame = (frame.unused_data or b"", make()) if frame.eof else (b"", frame)


def _library(kind: Compression) -> Any:  # noqa: ANN401 - a module without types
    with needing_extra("bag", f"logs compressed with {kind} need"):
        return import_module("zstandard" if kind == "zstd" else "lz4.frame")
