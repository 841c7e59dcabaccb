"""PNG files: read back by an inversion of their own, and broken ones refused."""

import contextlib
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.errors import DecodeError
from lcmtools_sim.vision.png import Picture, decode_png, encode_png

sizes = st.tuples(st.integers(1, 9), st.integers(1, 9))
seeds = st.integers(0, 2**32 - 1)


def grey(size: tuple[int, int] = (6, 5), seed: int = 1) -> Picture:
    return np.random.default_rng(seed).integers(0, 65536, size, np.uint16)


def color(size: tuple[int, int] = (6, 5), seed: int = 1) -> Picture:
    return np.random.default_rng(seed).integers(0, 256, (*size, 3), np.uint8)


def file_of(rows: list[bytes], width: int, pixel: int) -> bytes:
    """A file of rows that are already filtered."""
    bits, kind = (16, 0) if pixel == 2 else (8, 2)
    header = struct.pack(">IIBBBBB", width, len(rows), bits, kind, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"tEXt", b"Comment\0x"), (b"IDAT", zlib.compress(b"".join(rows)))]
    data = b"\x89PNG\r\n\x1a\n"
    for name, content in [*chunks, (b"IEND", b"")]:
        data += struct.pack(">I", len(content)) + name + content
        data += struct.pack(">I", zlib.crc32(name + content))
    return data


def predict(kind: int, left: int, above: int, corner: int) -> int:
    """What the standard's filter number ``kind`` takes off a byte."""
    guess = left + above - corner
    nearest = min((abs(guess - x), i, x) for i, x in enumerate((left, above, corner)))[2]
    return (0, left, above, (left + above) // 2, nearest)[kind]


def filtered(raw: bytes, width: int, pixel: int, kinds: list[int]) -> list[bytes]:
    """Rows filtered byte by byte, as the standard says."""
    size, rows, above = width * pixel, [], bytes(width * pixel)
    for number, kind in enumerate(kinds):
        row = raw[number * size : (number + 1) * size]
        out = bytearray([kind])
        for i, value in enumerate(row):
            left, corner = (row[i - pixel], above[i - pixel]) if i >= pixel else (0, 0)
            out.append((value - predict(kind, left, above[i], corner)) % 256)
        rows.append(bytes(out))
        above = row
    return rows


@given(sizes, seeds, st.sampled_from([grey, color]), st.integers(0, 9))
def test_a_picture_comes_back_as_it_was(
    size: tuple[int, int], seed: int, kind: type, level: int
) -> None:
    picture = kind(size, seed)

    again = decode_png(encode_png(picture, level))

    assert again.dtype == picture.dtype
    np.testing.assert_array_equal(again, picture)


@pytest.mark.parametrize(("picture", "pixel"), [(grey(), 2), (color(), 3)])
def test_a_file_is_what_the_standard_says(picture: Picture, pixel: int) -> None:
    data = encode_png(picture)
    raw = picture.astype(picture.dtype.newbyteorder(">")).tobytes()

    start = data.index(b"IDAT") + 4
    (size,) = struct.unpack(">I", data[start - 8 : start - 4])
    rows = zlib.decompress(data[start : start + size])

    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert data[12:16] == b"IHDR"
    assert struct.unpack(">II", data[16:24]) == (5, 6)
    assert rows == b"".join(filtered(raw, 5, pixel, [2] * 6))
    assert data.endswith(b"IEND\xaeB`\x82")


@given(st.lists(st.integers(0, 4), min_size=6, max_size=6), seeds, st.sampled_from([grey, color]))
def test_files_with_any_filters_are_read(kinds: list[int], seed: int, make: type) -> None:
    picture = make((6, 5), seed)
    pixel = 2 if picture.dtype == np.uint16 else 3
    raw = picture.astype(picture.dtype.newbyteorder(">")).tobytes()

    data = file_of(filtered(raw, 5, pixel, kinds), 5, pixel)

    np.testing.assert_array_equal(decode_png(data), picture)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "no PNG signature"),
        (encode_png(grey())[:-20], "unpack_from"),
        (encode_png(grey()).replace(b"IDAT", b"JDAT"), "wrong checksum"),
        (file_of([b"\x02ab"], 1, 2).replace(b"IEND", b"XEND"), "wrong checksum"),
        (file_of([b"\x07ab"], 1, 2), "unknown filter 7"),
        (file_of([b"\x02ab"], 4000, 2), "3 bytes of pixels instead of 8001"),
        (file_of([b"\x02ab"], 1 << 30, 2), "pixels"),
    ],
)
def test_a_broken_file_is_refused_in_one_line(data: bytes, said: str) -> None:
    with pytest.raises(DecodeError, match="broken PNG picture: .*" + said):
        decode_png(data)


@given(st.binary(max_size=60), st.integers(0, 120))
def test_no_bytes_do_more_than_be_refused(patch: bytes, at: int) -> None:
    data = bytearray(encode_png(color((9, 9))))
    data[at : at + len(patch)] = patch
    with contextlib.suppress(DecodeError):
        assert decode_png(bytes(data)).dtype in (np.uint8, np.uint16)


def test_only_grey_of_16_bits_and_colours_of_8_are_written() -> None:
    for wrong in (np.zeros((2, 2), np.uint8), np.zeros((2, 2, 4), np.uint8), np.zeros((2, 2))):
        with pytest.raises(ValueError, match="no picture"):
            encode_png(wrong)
