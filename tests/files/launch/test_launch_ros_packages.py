"""ROS packages of a workspace are found by $(find), by launch and by run."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import UsageError
from lcmtools.launch.executables import find_executable
from lcmtools.launch.packages import find_files, package_folder
from lcmtools.packages.programs import find_program
from lcmtools.packages.ros_packages import ros_packages

PACKAGES = {
    "src/rover_bringup": "rover_bringup",
    "src/navigation/rover_maps": "rover_maps",
    "src/navigation/renamed": "rover_navigation",
    "src/vendor/drivers/rover_laser": "rover_laser",
    "src/navigation/rover_maps/inside": "of_another",
    "deep/er/still/hidden": "hidden",
}


@pytest.fixture
def space(folder):
    """A catkin workspace with repositories, launch files and a script."""
    for place, name in PACKAGES.items():
        (folder / place / "launch").mkdir(parents=True)
        text = f"<package>\n  <name> {name} </name>\n</package>\n"
        (folder / place / "package.xml").write_text(text)
    (folder / "src/rover_bringup/launch/all.launch").write_text(
        '<launch><include file="$(find rover_maps)/launch/map.launch"/></launch>'
    )
    (folder / "src/navigation/rover_maps/launch/map.launch").write_text(
        '<launch><node pkg="rover_bringup" type="drive.py" name="d"'
        ' args="$(find rover_navigation)"/></launch>'
    )
    scripts = folder / "src/rover_bringup/scripts"
    scripts.mkdir()
    (scripts / "drive.py").write_text("#!/bin/sh\n")
    (scripts / "drive.py").chmod(0o755)
    (scripts / "notes.py").touch(mode=0o644)
    return folder


@pytest.mark.parametrize(
    "here", [".", "src", "src/rover_bringup/launch", "src/navigation", "src/navigation/renamed"]
)
def test_packages_are_found_from_everywhere_in_the_workspace(space, here):
    found = ros_packages(space / here)
    assert {name: str(found[name].relative_to(space)) for name in found if name != "hidden"} == {
        name: place for place, name in PACKAGES.items() if name not in ("hidden", "of_another")
    }


def test_launch_finds_a_package_its_file_and_its_scripts(plan, space):
    (file,) = find_files(["rover_bringup", "all.launch"])
    (node,) = plan(file.read_text()).nodes
    assert node.command[0] == str(space / "src/rover_bringup/scripts/drive.py")
    assert node.command[1] == str(space / "src/navigation/renamed")
    assert find_files(["rover_maps"]) == [space / "src/navigation/rover_maps/launch/map.launch"]


def test_run_finds_a_script_and_names_what_there_is(space):
    script = space / "src/rover_bringup/scripts/drive.py"
    assert find_program(["rover_bringup", "drive", "x"], space) == script
    assert find_program(["drive.py"], space) is None
    with raises_saying(UsageError, "rover_bringup", "'drve'", "did you mean drive.py?"):
        find_program(["rover_bringup", "drve"], space)
    with raises_saying(UsageError, "rover_bringup", "it has drive.py"):
        find_program(["rover_bringup"], space)
    with raises_saying(UsageError, "there is no node 'notes.py'", "chmod +x"):
        find_executable("rover_bringup", "notes.py", space)


def test_missing_package_is_named_with_a_near_one(space):
    with raises_saying(UsageError, "'rover_map'", "did you mean rover_maps?"):
        package_folder("rover_map", space)


def test_packages_beside_a_shared_folder_are_not_used(space):
    (space / "mine").mkdir()
    space.chmod(0o1777)
    assert "rover_maps" not in ros_packages(space / "mine")
