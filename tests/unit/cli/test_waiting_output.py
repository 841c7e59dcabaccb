"""Output that may wait for more, and output that may not."""

import io
import os
import sys
from pathlib import Path

import pytest

from lcmtools.cli.output import may_wait


def test_messages_wait_for_each_other_on_the_way_to_a_file_and_not_to_a_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ends = [os.fdopen(end, mode) for end, mode in zip(os.pipe(), "rw", strict=True)]
    with (tmp_path / "out").open("w") as file, ends[0], ends[1] as pipe:
        for stream, may in ((file, True), (pipe, False), (io.StringIO(), False)):
            monkeypatch.setattr(sys, "stdout", stream)
            assert may_wait() is may
            monkeypatch.undo()
