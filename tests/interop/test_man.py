"""The man pages, shown by man."""

import os
import shutil
import subprocess

import pytest
from man_pages import commands, main


@pytest.mark.skipif(not shutil.which("man"), reason="there is no man here")
def test_man_shows_every_page_without_a_warning(tmp_path):
    main([str(tmp_path / "man")])
    pages = [str(path) for path in sorted(tmp_path.glob("man/*.1"))]
    assert len(pages) == len([*commands()])
    done = subprocess.run(
        ["man", "--warnings", "-E", "UTF-8", "-l", *pages],  # noqa: S607 - where the system has it
        env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("EXIT STATUS") == len(pages)
