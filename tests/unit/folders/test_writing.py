"""Files that a person names: whole, or not at all."""

import os
import threading

import pytest
from fixtures.limits import small_files

from lcmtools.errors import LcmtoolsError
from lcmtools.folders import write_whole


@pytest.mark.parametrize("content", ["x" * 20_000, bytes(20_000)])
def test_a_full_disk_leaves_the_file_before_and_nothing_beside(content, tmp_path):
    path = tmp_path / "results.xml"
    path.write_text("mine")
    failure = pytest.raises(LcmtoolsError, match=r"cannot write .*results.xml: File too large")
    with small_files(), failure:
        write_whole(path, content)
    assert path.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [path]


def test_a_pipe_is_written_to_and_not_replaced(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writer = threading.Thread(target=write_whole, args=(path, "text"))
    writer.start()
    assert path.read_text() == "text"
    writer.join()
    assert path.is_fifo()
