"""There is a man page for every command, and man shows each without a warning."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from man_pages import commands, main, page

PAGES = [*commands()]
KNOWN = {".TH", ".SH", ".B", ".BR", ".I", ".PP", ".TP", ".nf", ".fi"}


def test_pages_have_what_a_page_has_and_no_line_that_roff_misreads() -> None:
    for words in PAGES:
        rows = page(words).splitlines()
        assert [row for row in rows if row.startswith(".SH")][:4] == [
            ".SH NAME",
            ".SH SYNOPSIS",
            ".SH DESCRIPTION",
            ".SH EXAMPLES",
        ], words
        assert {row.split()[0] for row in rows if row.startswith((".", "'"))} <= KNOWN, words
        assert "" not in rows, words


def test_page_of_echo_says_what_its_help_says() -> None:
    rows = page(("lcmtools", "echo")).splitlines()
    assert "lcmtools\\-echo \\- print the messages of a topic" in rows
    assert "[OPTIONS] TOPIC... [TYPE]" in rows
    assert "[OPTIONS] [TYPE]" in page(("lcmtools", "msg", "show")).splitlines()
    assert "[OPTIONS] [FILE] [NODE]" in page(("lcmtools", "param", "dump")).splitlines()
    assert ".B \\-1, \\-\\-once" in rows
    assert rows[rows.index(".SH EXAMPLES") + 1] == ".nf"
    assert ".B LCM_DEFAULT_URL" in rows


@pytest.mark.skipif(not shutil.which("man"), reason="there is no man here")
def test_man_shows_every_page_without_a_warning(tmp_path: Path) -> None:
    main([str(tmp_path / "man")])
    pages = [str(path) for path in sorted(tmp_path.glob("man/*.1"))]
    assert len(pages) == len(PAGES)
    done = subprocess.run(
        ["man", "--warnings", "-E", "UTF-8", "-l", *pages],  # noqa: S607 - where the system has it
        env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("EXIT STATUS") == len(pages)
