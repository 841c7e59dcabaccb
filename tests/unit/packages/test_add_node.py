"""A further node of a package: its file, and its line in pyproject.toml."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import InvalidName, LcmtoolsError, UsageError
from lcmtools.packages.add_node import add_node
from lcmtools.packages.create import NewPackage, create
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import workspace

MAIN = "def main(args=None):\n    pass\n"


@pytest.fixture
def package(tmp_path):
    create(NewPackage("lab", "drive", dependencies=("nav_msgs",)), tmp_path / "lab")
    return workspace(tmp_path).packages[0]


def nodes(package):
    return [node.name for node in runnables(package.folder) if node.package == package.name]


def test_a_node_is_written_and_declared_below_the_others(package):
    before = (package.folder / "pyproject.toml").read_text()
    written = add_node(package, "look")
    assert written == [package.folder / "lab/look.py", package.folder / "pyproject.toml"]
    text = (package.folder / "lab/look.py").read_text()
    assert "class Look(Node):" in text
    assert 'super().__init__("look")' in text
    assert "from lcmtools.types.nav_msgs import Odometry" in text
    drive = 'drive = "lab.drive:main"\n'
    after = (package.folder / "pyproject.toml").read_text()
    assert after == before.replace(drive, f'{drive}look = "lab.look:main"\n')
    assert nodes(package) == ["drive", "look"]


def test_a_file_that_is_there_is_only_declared(package):
    (package.folder / "lab/look.py").write_text(MAIN)
    assert add_node(package, "look") == [package.folder / "pyproject.toml"]
    assert (package.folder / "lab/look.py").read_text() == MAIN
    with raises_saying(UsageError, "lab", "'look'", "already", "lab/look.py"):
        add_node(package, "look")
    with raises_saying(UsageError, "look.py already exists", "--force"):
        add_node(package, "look", "new")
    assert add_node(package, "look", "new", replace=True) == [package.folder / "lab/look.py"]
    assert (package.folder / "lab/look.py").read_text() == "new"


def test_a_node_that_is_declared_gets_the_file_that_is_missing(package):
    (package.folder / "lab/drive.py").unlink()
    assert add_node(package, "drive") == [package.folder / "lab/drive.py"]


def test_a_file_without_a_main_function_is_no_node(package):
    before = (package.folder / "pyproject.toml").read_text()
    (package.folder / "lab/look.py").write_text("print(1)\n")
    with raises_saying(UsageError, "no function main"):
        add_node(package, "look")
    assert (package.folder / "pyproject.toml").read_text() == before


@pytest.mark.parametrize("name", ["Look", "a b", "msg", "class", "__init__", "../look"])
def test_names_that_no_file_can_have_are_refused(package, name):
    with pytest.raises(InvalidName):
        add_node(package, name)


@pytest.mark.parametrize(
    "project",
    [
        '[project]\nname = "lab"\n\n[tool.lcmtools]\n',
        (
            "[tool.lcmtools]\n[project]\nname = 'lab'\n[project.entry-points.'lcmtools.nodes']\n"
            "drive = 'lab:main' # first\n# more\n\n\n# tests\n[tool.pytest]\n"
        ),
    ],
)
def test_other_forms_of_a_description_are_understood(write, project):
    root = write({"lab/pyproject.toml": project, "lab/lab/__init__.py": ""})
    (package,) = workspace(root).packages
    add_node(package, "look")
    assert "look" in nodes(package)
    lines = (root / "lab/pyproject.toml").read_text().splitlines()
    assert [line for line in lines if line != 'look = "lab.look:main"'][:3] == (
        project.splitlines()[:3]
    )


def test_a_description_of_another_form_is_left_alone(write):
    project = (
        '[tool.lcmtools]\n[project]\nname = "lab"\n[project.entry-points]\n'
        '"lcmtools.nodes" = {drive = "lab:main"}\n'
    )
    root = write({"lab/pyproject.toml": project, "lab/lab/__init__.py": ""})
    (package,) = workspace(root).packages
    with raises_saying(LcmtoolsError, "; write", 'look = "lab'):
        add_node(package, "look")
    assert (root / "lab/pyproject.toml").read_text() == project
    assert not (root / "lab/lab/look.py").exists()
