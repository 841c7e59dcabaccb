"""Packages with nodes in C++: created, built, run and launched; liblcm and what may be missing."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.packages import cmake as cpp

RELAY = """\
#include <lcmtools/node.hpp>
#include <rover/Count.hpp>
#include <rover/Mark.hpp>
#include <rover/Shift.hpp>

int main(int argc, char** argv) {
  lcmtools::init(argc, argv);
  lcmtools::Node node("relay");
  auto marks = node.create_publisher<rover::Mark>("marks", 10);
  auto shifts = node.create_publisher<rover::Shift>("shifts", 10);
  node.create_subscription<rover::Count>("count", 10, [&](const rover::Count& count) {
    marks->publish(rover::Mark{"a mark", count.count + 7});
  });
  node.create_subscription<rover::Shift>("wishes", 10, [&](rover::Shift wish) {
    if (wish.gear == rover::Gear::HIGH) wish.all[1] = rover::Gear::BACK;
    shifts->publish(wish);
  });
  lcmtools::spin(node);
}
"""
READER = """\
import lcmtools

from rover.msg import Gear, Shift

def main(args=None):
    lcmtools.init(args)
    node = lcmtools.Node("reader")
    say = node.get_logger().info
    wishes = node.create_publisher(Shift, "wishes", 10)
    wish = Shift(gear=Gear.HIGH)
    node.create_timer(0.5, lambda: wishes.publish(wish))
    back = lambda shift: say(f"{shift.gear} {Gear(shift.all[1])!r}")
    node.create_subscription(Shift, "shifts", back, 1)
    kind = lcmtools.message_class("rover/Mark")
    node.create_subscription(kind, "marks", lambda mark: say(f"{mark.text} {mark.number}"), 1)
    lcmtools.spin(node)
    lcmtools.shutdown()
"""
BOTH = """\
nodes:
  - run: rover driver
  - run: rover reader
  - run: rover relay
"""
CREATE = ("pkg", "create", "rover", "--cpp", "--node", "driver", "--msg", "Count")


@pytest.fixture(autouse=True)
def space(tmp_path, bus_url, monkeypatch):
    """A folder for packages, in which commands run, on a bus of the test's own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return tmp_path


def test_a_new_package_is_built_and_runs(space, compiler, start, cli, lcmtools_path):
    assert compiler
    shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    assert_says(cli(*CREATE, "--deps", "geometry_msgs").err, "lcmtools pkg build rover")
    assert_line(
        cli("run", "rover", "driver").err, "driver", "not built", "lcmtools pkg build rover"
    )
    build = start(lcmtools_path, "pkg", "build", "rover")
    assert build.wait(200) == 0, build.output
    run = start(lcmtools_path, "run", "rover", "driver", "__ns:=/h")
    assert_says(run.wait_for("0 messages"), "[/h/driver]", "cmd_vel")
    assert "rover/Count" in cli("info", "/h/count").out
    launch = start(lcmtools_path, "launch", "rover/launch/driver.yaml")
    launch.wait_for("0 messages")
    source = space / "rover" / "src" / "driver.cpp"
    source.write_text(source.read_text().replace("++count_", "++counted_"))
    again = start(lcmtools_path, "pkg", "build", "rover")
    assert again.wait(200) == 1
    assert_says(again.output, "driver.cpp:", "counted_", "rover was not built; correct the first")


def test_nodes_of_both_languages_share_a_package_and_its_messages(
    space, compiler, start, cli, lcmtools_path
):
    assert compiler
    shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    assert cli("pkg", "create", "rover", "--node", "driver", "--msg", "Count").code == 0
    (space / "rover" / "msg").mkdir()
    (space / "rover" / "msg" / "Mark.msg").write_text("string text\nint32 number\n")
    (space / "rover" / "msg" / "Shift.lcm").write_text(
        "package rover;\nenum Gear { LOW = 0, HIGH = 3, BACK = -1 }\n"
        "struct Shift { Gear gear; Gear all[2]; }\n"
    )
    (space / "rover" / "src" / "relay.cpp").write_text(RELAY)
    (space / "rover" / "rover" / "reader.py").write_text(READER)
    assert cli("pkg", "add-node", "relay.cpp").code == 0
    assert cli("pkg", "add-node", "reader").code == 0
    (space / "both.yaml").write_text(BOTH)
    assert_says(cli("run", "--list").out, "rover driver", "rover relay", "(not built: lcmtools pkg")
    assert_line(cli("launch", "both.yaml").err, "relay", "not built", "lcmtools pkg build rover")
    build = start(lcmtools_path, "pkg", "build", "rover")
    assert build.wait(200) == 0, build.output
    launch = start(lcmtools_path, "launch", "both.yaml")
    launch.wait_for("[/reader]: a mark 7")
    launch.wait_for("[/reader]: HIGH BACK")
    assert_says(cli("node", "info", "/relay").out, "/marks [rover/Mark]", "/count [rover/Count]")


PROJECT = """\
cmake_minimum_required(VERSION 3.16)
project(own CXX)
find_package(lcmtools REQUIRED)
add_executable(own own.cpp)
target_link_libraries(own PRIVATE lcmtools::lcmtools)
lcmtools_generate(own acme std_msgs FOLDERS ../types)
"""
OWN = """\
#include <acme/sense/Scan.hpp>
#include <acme/Pose.hpp>
#include <std_msgs/String.hpp>
int main() { return acme::sense::Scan{}.%s + sizeof(acme::Pose) == 0; }
"""


def test_types_of_a_folder_are_generated_and_follow_their_files(space, compiler, lcmtools_path):
    assert compiler
    cmake = shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")

    def build(*words):
        done = subprocess.run([cmake, *words], capture_output=True, text=True, check=False)
        return "" if done.returncode == 0 else done.stdout + done.stderr

    types, project = space / "types" / "deep", space / "project"
    for folder in (types, project):
        folder.mkdir(parents=True)
    scan, pose = types / "scan.lcm", types / "Pose.msg"
    scan.write_text("package acme.sense;\nstruct Scan { int32_t old; acme.Pose at; }\n")
    pose.write_text("float64 x\n")
    (types.parent / "acme").mkdir()
    pose.rename(types.parent / "acme" / "Pose.msg")
    (project / "CMakeLists.txt").write_text(PROJECT.replace(" acme ", " acme acme.sense "))
    (project / "own.cpp").write_text(OWN % "old")
    options = [
        f"-DCMAKE_PREFIX_PATH={cpp.cpp_folder()}",
        f"-DLCMTOOLS_PROGRAM={lcmtools_path}",
    ]
    assert build("-S", "project", "-B", "build", *options) == ""
    assert build("--build", "build") == ""
    scan.write_text("package acme.sense;\nstruct Scan { int32_t newer; acme.Pose at; }\n")
    assert_says(build("--build", "build"), "own.cpp:", "old")
    (project / "own.cpp").write_text(OWN % "newer")
    assert build("--build", "build") == ""
    scan.write_text("package acme.sense;\nstruct Scan {\n  int32_t class;\n}\n")
    assert_says(build("--build", "build"), "scan.lcm:3: 'class' is a keyword of C++")
    (space / "types").rename(space / "moved")
    assert_says(build("-S", "project", "-B", "build"), "there is no folder", "types")


@pytest.mark.parametrize(
    ("missing", "package"), [("cmake", "cmake"), ("c++", "g++"), ("make", "make")]
)
def test_a_missing_program_is_named_with_its_package(missing, package, cli, monkeypatch):
    cli(*CREATE)
    found = shutil.which
    monkeypatch.setattr(
        shutil, "which", lambda name: None if name == missing else found(name) or f"/bin/{name}"
    )
    result = cli("pkg", "build", "rover")
    assert result.code != 0
    assert_says(result.err, f"'{missing}'", f"sudo apt install {package}")


def test_a_missing_liblcm_is_named(cli, monkeypatch):
    monkeypatch.setattr(cpp, "find_spec", lambda _: None)
    monkeypatch.setattr(cpp, "_pkg_config_flags", lambda _: ())
    assert_line(cli("pkg", "cpp-path", "--flags").err, "liblcm", "liblcm-dev", "pip install lcm")


def test_the_liblcm_of_the_system_comes_first(cli, monkeypatch):
    monkeypatch.setattr(cpp, "_pkg_config_flags", lambda name: ("-I/opt/lcm", f"-l{name}"))
    assert_says(cli("pkg", "cpp-path", "--flags").out, "-std=c++17", "-I/opt/lcm -llcm")


def test_the_folder_has_headers_and_packages(cli):
    folder = Path(cli("pkg", "cpp-path").out.strip())
    assert (folder / "lcmtools" / "node.hpp").is_file()
    assert (folder / "cmake" / "lcmtoolsConfig.cmake").is_file()
    record = json.loads(cli("pkg", "cpp-path", "--json").out)
    assert (record["folder"], record["pkg_config"]) == (str(folder), str(folder / "pkgconfig"))
    assert (Path(cli("pkg", "cpp-path", "--lcm").out.strip()) / "include/lcm/lcm.h").is_file()
