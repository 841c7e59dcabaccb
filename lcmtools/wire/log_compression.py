"""Compressed logs: frames one after another, each with whole events.

Sans-I/O. If a log was cut off, the part after its last whole frame is read as far as possible. The
libraries belong to the extra ``bag``, and are imported when needed.
"""

from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from typing import Any, Literal

from lcmtools.errors import needing_extra

Compression = Literal["zstd", "lz4"]
SUFFIXES: dict[Compression, str] = {"zstd": ".zst", "lz4": ".lz4"}
_MAGIC: dict[Compression, bytes] = {"zstd": b"\x28\xb5\x2f\xfd", "lz4": b"\x04\x22\x4d\x18"}


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


def decompressed(kind: Compression, chunks: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the content of the frames in a file's chunks, up to the first damage.

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
