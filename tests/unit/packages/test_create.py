"""A new package: what is written, and that it is all or nothing."""

import compileall

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import LcmtoolsError
from lcmtools.packages.create import NewPackage, create


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def test_everything_is_written_and_is_python(tmp_path):
    folder = tmp_path / "lab"
    written = create(NewPackage("lab", "drive", "Stat", ("nav_msgs",), "MIT"), folder)
    assert {str(path) for path in written} == files(folder)
    assert files(folder) >= {
        "pyproject.toml",
        "README.md",
        ".gitignore",
        "lab/drive.py",
        "lab/msg/Stat.lcm",
        "launch/drive.yaml",
        "tests/test_drive.py",
    }
    assert not [name for name in files(folder) if "$" in (folder / name).read_text()]
    assert compileall.compile_dir(folder, quiet=1)


def test_without_a_message_there_is_no_folder_for_it(tmp_path):
    create(NewPackage("lab", "drive"), tmp_path / "lab")
    assert not (tmp_path / "lab/lab/msg").exists()
    assert "license" not in (tmp_path / "lab/pyproject.toml").read_text()


def test_what_is_there_is_kept_unless_it_is_to_be_replaced(tmp_path):
    folder = tmp_path / "lab"
    folder.mkdir()
    (folder / "README.md").write_text("mine")
    with raises_saying(LcmtoolsError, "README.md already exists", "--force"):
        create(NewPackage("lab", "drive"), folder)
    assert files(folder) == {"README.md"}
    assert (folder / "README.md").read_text() == "mine"
    create(NewPackage("lab", "drive"), folder, replace=True)
    assert (folder / "README.md").read_text() != "mine"


def test_where_nothing_can_be_written_nothing_stays(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LcmtoolsError, match="cannot write"):
        create(NewPackage("lab", "drive"), tmp_path / "file" / "lab")
    blocked = tmp_path / "lab"
    (blocked / "lab").mkdir(parents=True)
    (blocked / "tests").write_text("in the way of a folder")
    with pytest.raises(LcmtoolsError, match="cannot write"):
        create(NewPackage("lab", "drive"), blocked)
    assert not [name for name in files(blocked) if ".making" in name]
