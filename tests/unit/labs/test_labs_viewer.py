"""The check of a viewer, without a bus: a file that is written again and again."""

import io
from dataclasses import replace
from types import SimpleNamespace

import PIL.Image
import pytest

from lcmtools.labs.checks import viewer

_FILE = io.BytesIO()
PIL.Image.new("I;16", (4, 2)).save(_FILE, "PNG")
PICTURE = _FILE.getvalue()


@pytest.fixture
def first_row(tmp_path, monkeypatch):
    """``first_row(later)``: of a check that looks for a picture once before the file changes."""

    def check(later):
        def wait(condition, _):
            is_true = bool(condition())
            (tmp_path / "picture.png").write_bytes(later)
            return is_true

        def first(_bench, has_come, _, row):
            return replace(row, is_ok=wait(has_come, 0.0) or bool(has_come()))

        monkeypatch.setattr(viewer, "first", first)
        recorder = SimpleNamespace(record=lambda *_: [])
        bench = SimpleNamespace(folder=tmp_path, recorder=recorder, start=lambda _: None, wait=wait)
        return next(viewer.check_viewer(bench, ["viewer"]))

    return check


def test_a_picture_counts_although_the_next_one_is_being_written(first_row, tmp_path):
    (tmp_path / "picture.png").write_bytes(PICTURE)
    result = first_row(later=b"")
    assert (result.measured, result.is_ok) == ("4 x 2 pixels", True)


def test_a_picture_that_comes_as_the_program_ends_counts(first_row):
    assert first_row(later=PICTURE).is_ok


def test_a_file_that_never_is_a_picture_is_reported(first_row):
    result = first_row(later=b"nothing")
    assert (result.measured, result.is_ok) == ("a file that is not a picture", False)
