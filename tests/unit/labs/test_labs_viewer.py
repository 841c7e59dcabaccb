"""The check of a viewer, without a bus: a file that is written again and again."""

import io
from dataclasses import replace
from types import SimpleNamespace

import PIL.Image

from lcmtools.labs.checks.viewer import check_viewer

_FILE = io.BytesIO()
PIL.Image.new("I;16", (4, 2)).save(_FILE, "PNG")
PICTURE = _FILE.getvalue()


def bench(folder, later):
    """Return a test bench that evaluates a condition once, and then changes the file."""

    def wait(condition, _):
        is_true = bool(condition())
        (folder / "picture.png").write_bytes(later)
        return is_true

    def first(has_come, _, row):
        return replace(row, is_ok=wait(has_come, 0.0) or bool(has_come()))

    return SimpleNamespace(
        folder=folder,
        recorder=SimpleNamespace(record=lambda *_: []),
        start=lambda *_: SimpleNamespace(code=None),
        wait=wait,
        first=first,
    )


def test_a_picture_counts_although_the_next_one_is_being_written(tmp_path):
    (tmp_path / "picture.png").write_bytes(PICTURE)
    result = next(check_viewer(bench(tmp_path, later=b""), ["viewer"]))
    assert (result.measured, result.is_ok) == ("4 x 2 pixels", True)


def test_a_picture_that_comes_as_the_program_ends_counts(tmp_path):
    assert next(check_viewer(bench(tmp_path, later=PICTURE), ["viewer"])).is_ok


def test_a_file_that_never_is_a_picture_is_reported(tmp_path):
    result = next(check_viewer(bench(tmp_path, later=b"nothing"), ["viewer"]))
    assert (result.measured, result.is_ok) == ("a file that is not a picture", False)
