"""The check of a viewer, without a bus: a file that is written again and again."""

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import PIL.Image
import pytest

from lcmtools.labs.checks.pioneer import check_viewer

_FILE = io.BytesIO()
PIL.Image.new("I;16", (4, 2)).save(_FILE, "PNG")
PICTURE = _FILE.getvalue()


@pytest.fixture
def stage(tmp_path: Path) -> Any:
    """A stage that waits by asking once."""
    return SimpleNamespace(
        folder=tmp_path,
        listen=lambda *_: None,
        start=lambda _: SimpleNamespace(code=lambda: None),
        wait=lambda condition, _: bool(condition()),
    )


def test_a_picture_counts_although_it_is_being_written_anew(stage: Any, tmp_path: Path) -> None:
    file = tmp_path / "picture.png"
    file.write_bytes(PICTURE)

    def wait(condition: Any, _: float) -> bool:
        is_there = bool(condition())
        file.write_bytes(b"")  # as who begins to write the next one
        return is_there

    stage.wait = wait
    row = next(check_viewer(stage, ["viewer"]))

    assert (row.measured, row.is_ok) == ("4 x 2 pixels", True)


def test_a_picture_that_comes_with_the_programs_last_breath_counts(
    stage: Any, tmp_path: Path
) -> None:
    def wait(condition: Any, _: float) -> bool:
        is_there = bool(condition())
        (tmp_path / "picture.png").write_bytes(PICTURE)
        return is_there

    stage.wait = wait
    assert next(check_viewer(stage, ["viewer"])).is_ok


def test_a_file_that_never_is_a_picture_is_told(stage: Any, tmp_path: Path) -> None:
    (tmp_path / "picture.png").write_bytes(b"nothing")
    row = next(check_viewer(stage, ["viewer"]))

    assert (row.measured, row.is_ok) == ("a file that is no picture", False)
