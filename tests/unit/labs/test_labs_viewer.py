"""The check of a viewer, without a bus: a file that is written again and again."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from lcmtools.labs.checks.pioneer import check_viewer
from lcmtools.labs.nodes.picture.png import PngPixels, encode_png

PICTURE = encode_png(PngPixels(4, 2, 1, 16, bytes(16)))


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

    assert (row.measured, row.is_ok) == ("a file that is no such PNG", False)
