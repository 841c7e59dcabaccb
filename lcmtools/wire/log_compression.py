"""Logs that are compressed: frames one after another, each with whole events.

Sans-I/O. What is behind the last whole frame of a log that was cut off is read as far as it goes.
The libraries belong to the extra ``bag``, and are imported when they are needed.
"""

from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from typing import Any, Literal

from lcmtools.errors import needing_extra

Compression = Literal["zstd", "lz4"]
SUFFIXES: dict[Compression, str] = {"zstd": ".zst", "lz4": ".lz4"}
_MAGIC: dict[Compression, bytes] = {"zstd": b"\x28\xb5\x2f\xfd", "lz4": b"\x04\x22\x4d\x18"}


def compression_of(head: bytes) -> Compression | None:
    """Return how a file that begins so is compressed; None for one that is not."""
    return next((kind for kind, magic in _MAGIC.items() if head.startswith(magic)), None)


def compressor(kind: Compression) -> Callable[[bytes], bytes]:
    """Return a function that makes one frame of some bytes.

    Raises:
        MissingExtra: The library is missing.
    """
    library = _library(kind)
    if kind == "zstd":
        return library.ZstdCompressor().compress  # type: ignore[no-any-return]
    return library.compress  # type: ignore[no-any-return]


def decompressed(kind: Compression, chunks: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the bytes of the frames in some chunks of a file, up to the first damage.

    Raises:
        MissingExtra: The library is missing.
    """
    library = _library(kind)
    is_zstd = kind == "zstd"
    make = library.ZstdDecompressor().decompressobj if is_zstd else library.LZ4FrameDecompressor
    failure = library.ZstdError if is_zstd else RuntimeError
    frame = make()
    for chunk in chunks:
        rest = chunk
        while rest:
            if frame.eof:
                frame = make()
            try:
                yield frame.decompress(rest)
            except failure:
                return
            rest = frame.unused_data or b""


def _library(kind: Compression) -> Any:  # noqa: ANN401 - a module without types
    with needing_extra("bag", f"logs compressed with {kind} need"):
        return import_module("zstandard" if kind == "zstd" else "lz4.frame")
