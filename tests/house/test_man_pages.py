"""The man pages are fresh, there is one for every command, and man shows each without a warning."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from lcmtools.cli.manual import commands, main, page, stale

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "man"
PAGES = [*commands()]


def test_committed_pages_are_fresh() -> None:
    names = [path.name for path in stale(FOLDER)]
    assert names == [], "run: python -m lcmtools.cli.manual docs/man"


def test_stale_stray_and_missing_pages_are_reported_and_mended(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path)]) == 0
    assert main([str(tmp_path), "--check"]) == 0
    (tmp_path / "lcmtools-list.1").write_text("old")
    (tmp_path / "lcmtools-gone.1").touch()
    (tmp_path / "lcmtools.1").unlink()
    capsys.readouterr()
    assert main([str(tmp_path), "--check"]) == 1
    wrong = ("lcmtools-gone.1", "lcmtools-list.1", "lcmtools.1")
    assert capsys.readouterr().out == "".join(f"stale: {tmp_path / name}\n" for name in wrong)
    assert main([str(tmp_path)]) == 0
    assert stale(tmp_path) == {}


@pytest.mark.parametrize("words", PAGES, ids=" ".join)
def test_page_has_what_a_page_has_and_no_line_that_roff_misreads(words: tuple[str, ...]) -> None:
    rows = page(words).splitlines()
    assert [row for row in rows if row.startswith(".SH")][:4] == [
        ".SH NAME",
        ".SH SYNOPSIS",
        ".SH DESCRIPTION",
        ".SH EXAMPLES",
    ]
    known = {".TH", ".SH", ".B", ".BR", ".I", ".PP", ".TP", ".nf", ".fi"}
    assert {row.split()[0] for row in rows if row.startswith((".", "'"))} <= known
    assert "" not in rows


@pytest.mark.skipif(not shutil.which("man"), reason="there is no man here")
def test_man_shows_every_page_without_a_warning(tmp_path: Path) -> None:
    main([str(tmp_path)])
    pages = [str(path) for path in sorted(tmp_path.glob("*.1"))]
    done = subprocess.run(
        ["man", "--warnings", "-E", "UTF-8", "-l", *pages],  # noqa: S607 - where the system has it
        env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("EXIT STATUS") == len(pages)
