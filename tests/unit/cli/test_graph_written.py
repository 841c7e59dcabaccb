"""Where a picture goes and in what form."""

import json
import os
import stat
from pathlib import Path

import pytest

from lcmtools.cli.graph.written import Output, chosen
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Flow, Member

_PICTURE = Diagram(
    (Member("n1", "/a"),), (Channel("t1", "x\udcff"),), (Edge("n1", "t1", Flow.PUBLISHES),)
)


@pytest.mark.parametrize(
    ("form", "file", "as_json", "expected"),
    [
        (None, None, False, Output("text")),
        (None, "-", False, Output("text")),
        ("svg", "-", False, Output("svg")),
        (None, None, True, Output("json")),
        ("json", None, True, Output("json")),
        (None, "a.svg", False, Output("svg", "a.svg")),
        (None, "a.GV", False, Output("dot", "a.GV")),
        (None, "a.dot", False, Output("dot", "a.dot")),
        (None, "a.mmd", False, Output("mermaid", "a.mmd")),
        (None, "a.md", False, Output("mermaid", "a.md")),
        (None, "a.json", False, Output("json", "a.json")),
        (None, "a.txt", False, Output("text", "a.txt")),
        ("dot", "a.txt", False, Output("dot", "a.txt")),
        ("dot", "a", False, Output("dot", "a")),
    ],
)
def test_the_form_is_what_is_said_or_the_files_name_tells(
    form: str | None, file: str | None, *, as_json: bool, expected: Output
) -> None:
    assert chosen(form, file, as_json=as_json, force=False) == expected


def test_a_file_is_overwritten_only_by_force(tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    file.write_text("mine")
    with pytest.raises(UsageError, match="there already; --force overwrites it"):
        chosen(None, str(file), as_json=False, force=False)
    chosen(None, str(file), as_json=False, force=True).write(_PICTURE)
    assert file.read_text().startswith("<?xml")


@pytest.mark.parametrize("suffix", ["txt", "dot", "mmd", "md", "json", "svg"])
def test_a_file_is_whole_and_utf_8(suffix: str, tmp_path: Path) -> None:
    file = tmp_path / f"a.{suffix}"
    chosen(None, str(file), as_json=False, force=False).write(_PICTURE)
    text = file.read_text(encoding="utf-8")
    assert text.endswith("\n")
    assert "/a" in text
    assert os.listdir(tmp_path) == [file.name]  # noqa: PTH208 - names are enough


def test_markdown_has_the_picture_as_a_block(tmp_path: Path) -> None:
    file = tmp_path / "a.md"
    chosen(None, str(file), as_json=False, force=False).write(_PICTURE)
    assert file.read_text().startswith("```mermaid\nflowchart LR\n")


def test_json_keeps_the_bytes_of_a_name_that_is_no_utf_8(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    chosen(None, str(file), as_json=False, force=False).write(_PICTURE)
    assert json.loads(file.read_text())["topics"][0]["topic"] == "x\udcff"


def test_what_cannot_be_written_is_one_error(tmp_path: Path) -> None:
    file = tmp_path / "none" / "a.svg"
    with pytest.raises(LcmtoolsError, match=r"cannot write .*a\.svg: No such file or directory"):
        Output("svg", str(file)).write(_PICTURE)
    with pytest.raises(LcmtoolsError, match="Is a directory"):
        Output("svg", str(tmp_path)).write(_PICTURE)


def test_a_pipe_is_written_into_and_not_replaced(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        Output("dot", str(pipe)).write(_PICTURE)
        assert os.read(reader, 7) == b"digraph"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
