"""Output that may wait for more or may not, and bytes that are no UTF-8."""

import io
import os
import sys

from lcmtools.cli.output import may_wait, write_lines


def test_messages_wait_for_each_other_on_the_way_to_a_file_and_not_to_a_program(
    tmp_path, monkeypatch
):
    ends = [os.fdopen(end, mode) for end, mode in zip(os.pipe(), "rw", strict=True)]
    with (tmp_path / "out").open("w") as file, ends[0], ends[1] as pipe:
        for stream, may in ((file, True), (pipe, False), (io.StringIO(), False)):
            monkeypatch.setattr(sys, "stdout", stream)
            assert may_wait() is may
            monkeypatch.undo()


def test_a_byte_that_is_no_utf_8_is_written_as_everywhere(capsys):
    write_lines(["a\udcff\x1b"])
    assert capsys.readouterr().out == "a\\xff\\x1b\n"
