"""Where a picture goes and in what form."""

import json
import os
import shutil
import stat
from xml.etree import ElementTree as ET

import pytest
from fixtures.programs import PYTHON_SCRIPT

from lcmtools.cli.graph import chosen_output, write
from lcmtools.errors import LcmtoolsError, MissingExtra, UsageError
from lcmtools.graph.drawing import dot
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation

_PICTURE = Diagram(
    (Member("n1", "/a"),), (Channel("t1", "x\udcff"),), (Edge("n1", "t1", Relation.PUBLISHES),)
)


@pytest.mark.parametrize(
    ("form", "file", "as_json", "expected"),
    [
        (None, None, False, ("text", "-")),
        (None, "-", False, ("text", "-")),
        ("dot", "-", False, ("dot", "-")),
        (None, None, True, ("json", "-")),
        ("json", None, True, ("json", "-")),
        (None, "a.GV", False, ("dot", "a.GV")),
        (None, "a.dot", False, ("dot", "a.dot")),
        (None, "a.mmd", False, ("mermaid", "a.mmd")),
        (None, "a.md", False, ("mermaid", "a.md")),
        (None, "a.json", False, ("json", "a.json")),
        (None, "a.txt", False, ("text", "a.txt")),
        ("dot", "a.txt", False, ("dot", "a.txt")),
        ("dot", "a", False, ("dot", "a")),
    ],
)
def test_the_form_is_what_is_said_or_the_files_name_tells(form, file, *, as_json, expected):
    assert chosen_output(form, file, as_json=as_json, force=False) == expected


def test_a_file_is_overwritten_only_by_force(tmp_path):
    file = tmp_path / "a.dot"
    file.write_text("mine")
    with pytest.raises(UsageError, match="already exists; --force overwrites it"):
        chosen_output(None, str(file), as_json=False, force=False)
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=True))
    assert file.read_text().startswith("digraph")


@pytest.mark.parametrize("suffix", ["txt", "dot", "mmd", "md", "json"])
def test_a_file_is_whole_and_utf_8(suffix, tmp_path):
    file = tmp_path / f"a.{suffix}"
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=False))
    text = file.read_text(encoding="utf-8")
    assert text.endswith("\n")
    assert "/a" in text
    assert os.listdir(tmp_path) == [file.name]  # noqa: PTH208 - names are enough


def test_markdown_has_the_picture_as_a_block(tmp_path):
    file = tmp_path / "a.md"
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=False))
    assert file.read_text().startswith("```mermaid\nflowchart LR\n")


def test_json_keeps_the_bytes_of_a_name_that_is_no_utf_8(tmp_path):
    file = tmp_path / "a.json"
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=False))
    assert json.loads(file.read_text())["topics"][0]["topic"] == "x\udcff"


def test_what_cannot_be_written_is_one_error(tmp_path):
    file = tmp_path / "none" / "a.dot"
    with pytest.raises(LcmtoolsError, match=r"cannot write .*a\.dot: No such file or directory"):
        write(_PICTURE, "dot", str(file))
    with pytest.raises(LcmtoolsError, match="is a folder"):
        write(_PICTURE, "dot", str(tmp_path))


def test_a_pipe_is_written_into_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write(_PICTURE, "dot", str(pipe))
        assert os.read(reader, 7) == b"digraph"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def fake_dot(folder, script):
    """Put a Python script into a folder as Graphviz's program."""
    program = folder / "dot"
    program.write_text(f"{PYTHON_SCRIPT}\nimport pathlib, sys\n{script}\n")
    program.chmod(0o755)


@pytest.fixture
def path(tmp_path, monkeypatch):
    """A folder that alone is on PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    return folder


def test_without_graphviz_one_line_says_what_to_use_instead(path):
    del path
    for form, file in (("svg", None), (None, "a.svg"), ("svg", "a.txt")):
        with pytest.raises(MissingExtra) as caught:
            chosen_output(form, file, as_json=False, force=False)
        assert str(caught.value) == (
            "SVG needs Graphviz's program dot, which is not installed; install graphviz, or use"
            " --format dot or mermaid"
        )
        assert caught.value.exit_code == 3


def test_svg_is_what_graphviz_makes_of_the_dot_document(path, tmp_path):
    fake_dot(path, f"pathlib.Path({str(path)!r}, 'args').write_text(repr(sys.argv[1:]))\n"
             "print('<svg>' + sys.stdin.read() + '</svg>')")  # fmt: skip
    file = tmp_path / "a.svg"
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=False))
    assert file.read_text() == f"<svg>{dot.write(_PICTURE)}</svg>\n"
    assert (path / "args").read_text() == "['-Tsvg']"


def test_a_graphviz_that_fails_is_one_line_and_no_file(path, tmp_path):
    fake_dot(path, "sys.exit('Error: out of memory\\nmore')")
    with pytest.raises(LcmtoolsError, match=r"^Graphviz's dot failed \(Error: out of memory\)$"):
        write(_PICTURE, "svg", str(tmp_path / "a.svg"))
    assert not (tmp_path / "a.svg").exists()


@pytest.mark.skipif(shutil.which("dot") is None, reason="needs Graphviz")
def test_graphviz_draws_every_name(tmp_path):
    file = tmp_path / "a.svg"
    write(_PICTURE, *chosen_output(None, str(file), as_json=False, force=False))
    texts = [text.text for text in ET.parse(file).iter("{http://www.w3.org/2000/svg}text")]  # noqa: S314
    assert texts == ["/a", "x\\xff", "unknown type"]
