"""Compressed logs that unpack to far more than they have: in pieces, and only if there is room."""

import bz2
import resource
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import pytest

from lcmtools.wire.log_compression import (
    compressor,
    decompressed,
    decompressed_bytes,
)

KINDS = ("zstd", "lz4")
LARGE = 256 << 20
"""Bytes in a file of some kB."""


class Usage(NamedTuple):
    """A disk's space, as ``shutil.disk_usage`` has it."""

    total: int
    used: int
    free: int


@pytest.fixture(params=KINDS)
def bomb(request, tmp_path):
    """A file of zeros, compressed in pieces."""
    path = tmp_path / "bomb.lcmlog"
    kind = request.param
    with path.open("wb") as file:
        if kind == "zstd":
            with (
                import_module("zstandard")
                .ZstdCompressor()
                .stream_writer(file, closefd=False) as writer
            ):
                for _ in range(LARGE >> 20):
                    writer.write(bytes(1 << 20))
        else:
            made = import_module("lz4.frame").LZ4FrameCompressor()
            file.write(made.begin())
            for _ in range(LARGE >> 20):
                file.write(made.compress(bytes(1 << 20)))
            file.write(made.flush())
    return kind, path


@pytest.fixture
def small_memory():
    """The process may have 100 MB more."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(
        resource.RLIMIT_AS, (pages * resource.getpagesize() + (100 << 20), before[1])
    )
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.usefixtures("small_memory")
def test_it_is_unpacked_in_pieces(bomb):
    kind, path = bomb
    with path.open("rb") as file:
        sizes = [len(piece) for piece in decompressed(kind, file)]
    assert sum(sizes) == LARGE
    assert max(sizes) <= 1 << 20


@pytest.mark.usefixtures("small_memory")
def test_bz2_in_ros_bags_is_unpacked_in_pieces_too():
    bomb = bz2.compress(bytes(LARGE >> 4)) * 16
    assert len(bomb) < 1000
    assert max(map(len, decompressed("bz2", BytesIO(bomb)))) <= 1 << 20
    with pytest.raises(ValueError, match="its content has more than 10000000 bytes"):
        decompressed_bytes("bz2", bomb, 10_000_000)


@pytest.mark.usefixtures("small_memory")
def test_so_many_bytes_are_refused(bomb):
    with pytest.raises(ValueError, match="its content has more than 10000000 bytes"):
        decompressed_bytes(bomb[0], bomb[1].read_bytes(), 10_000_000)


def test_it_must_fit_into_the_free_space(bomb, cli, monkeypatch):
    monkeypatch.setattr("shutil.disk_usage", lambda _: Usage(LARGE, 0, LARGE))
    result = cli("bag", "info", str(bomb[1]))
    assert "bomb.lcmlog has more than" in result.err
    assert "set TMPDIR to a folder with more space" in result.err
    assert result.code == 1


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [0, 1, 100_000, 3 << 20])
def test_frames_one_after_another_give_their_content(kind, size):
    compress = compressor(kind)
    frames = compress(bytes(size)) + compress(b"end") + compress(b"")
    assert decompressed_bytes(kind, frames, 1 << 30) == bytes(size) + b"end"
    assert decompressed_bytes(kind, frames + b"stray", 1 << 30) == bytes(size) + b"end"
    cut = decompressed_bytes(kind, frames[:-1], 1 << 30)
    assert bytes(size).startswith(cut[:size])
