"""The labs in C++: skeletons compile, and the model answers pass the checks of their labs."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools.bag.writer import LogWriter
from lcmtools.errors import LcmtoolsError
from lcmtools.labs import skeletons
from lcmtools.packages import cmake as cpp
from lcmtools.packages.cmake import built_source, compiler_flags
from lcmtools.types.nav_msgs import Odometry
from lcmtools.wire.packet import Packet

ROOT = Path(__file__).parents[2]
CHECKS = {
    "kinect_viewer": ("pioneer", "viewer"),
    "moving_robot": ("dolly", "mover"),
    "pioneer_manual_controller": ("pioneer", "teleop"),
    "simple_controller": ("husky", "controller"),
}
TYPES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "std_srvs")


@pytest.fixture(scope="module")
def compile_program(compiler, lcmtools_path, tmp_path_factory):
    """``compile_program(source, flag...)``: compiles it; warnings are errors."""
    folder = tmp_path_factory.mktemp("labs")
    generate = [lcmtools_path, "msg", "generate", "--lang", "cpp", str(folder / "types"), *TYPES]
    subprocess.run(generate, capture_output=True, check=True)

    def make(source, *flags):
        program = folder / source.stem
        words = ["-O0", "-Wall", "-Wextra", "-Werror", *flags, str(source), f"-I{folder / 'types'}"]
        command = [compiler, *words, *compiler_flags(), "-o", str(program)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return program

    return make


def answer(name):
    return Path(skeletons.__file__).with_name(f"{name}.cpp")


@pytest.mark.parametrize("name", skeletons.CPP_NAMES)
def test_a_skeleton_compiles_as_it_is(name, compile_program):
    compile_program(answer(name), "-fsyntax-only", "-DSKELETON")


@pytest.mark.parametrize("page", ["coming-from-ros1.md", "coming-from-ros2.md"])
def test_what_a_page_writes_in_place_of_ros_compiles(page, compile_program):
    part = (ROOT / "docs" / page).read_text().partition("cpp\n\n[Nodes in C++]")[2]
    named = re.findall(
        r"lcmtools::\w+|create_\w+|declare_\w+|\w+/\w+\.hpp", part.partition("##")[0]
    )
    source = Path(__file__).parent / "programs" / "as_in_ros.cpp"
    known = f"{source.read_text()} std_msgs/String.hpp rclcpp/rclcpp.hpp msg/twist.hpp"
    assert len(named) > 5
    assert [word for word in named if word not in known] == []
    compile_program(source, "-fsyntax-only")


@pytest.mark.usefixtures("quiet_network")
@pytest.mark.parametrize("name", CHECKS)
def test_a_model_answer_passes_its_check(name, compile_program, cli):
    program = compile_program(answer(name))
    lab, option = CHECKS[name]
    checked = cli("lab", "check", lab, f"--{option}", str(program))
    assert checked.code == 0, checked


@pytest.mark.parametrize(
    ("name", "topic"), [("simple_controller", "odometry"), ("moving_robot", "other")]
)
def test_a_recording_is_played_to_a_model_answer_in_lock_step(
    name, topic, compile_program, cli, tmp_path
):
    program = ("--", str(compile_program(answer(name))))
    inputs, saved = tmp_path / "inputs.lcmlog", tmp_path / "saved.lcmlog"
    with LogWriter(inputs) as log:
        for n in range(100):
            message = Odometry()
            message.twist.twist.linear.x = n / 100
            log.add(Packet(f"/{topic}", message.encode(), 10**18 + n * 20_000_000))
    assert cli("bag", "rerun", str(inputs), "--save", str(saved), *program).code == 1
    done = cli("bag", "rerun", str(saved), "--twice", "--json", *program)
    report = json.loads(done.out)
    assert (done.code, report["lockstep"]) == (0, True), report
    assert [one["matched"] for one in report["topics"]] == [100 if topic == "odometry" else 3]


@pytest.mark.usefixtures("quiet_network")
def test_the_sources_of_a_class_are_built_and_checked(compiler, cli, tmp_path, monkeypatch):
    """In the packages of the submissions, or alone; one that does not compile fails alone."""
    assert compiler
    shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    create = ("rover", "--cpp", "--node", "moving_robot", "--msg", "Count", "--deps")
    assert cli("pkg", "create", *create, "geometry_msgs").code == 0
    mover = answer("moving_robot").read_text()
    Path("rover/src/moving_robot.cpp").write_text(f"#include <rover/Count.hpp>\n{mover}")
    with Path("rover/CMakeLists.txt").open("a") as project:
        project.write("add_executable(unfinished src/unfinished.cpp)\n")
    Path("rover/src/unfinished.cpp").write_text("int main() { unfinished")
    Path("class/anna b").mkdir(parents=True)
    Path("rover").rename("class/rover")
    Path("class/anna b/my moving_robot.cpp").write_text(mover)
    wrong = mover.replace("{ timer_callback", "{ timr_callback")
    Path("class/cy.cpp").write_text(wrong)
    result = cli("lab", "check", "dolly", "--programs", "class", "--json")
    rows = {one["submission"]: one["rows"] for one in json.loads(result.out)}
    assert [(name, all(row["ok"] for row in found)) for name, found in rows.items()] == [
        ("anna b", True),
        ("cy.cpp", False),
        ("rover", True),
    ]
    (row,) = rows["cy.cpp"]
    assert row["what"] == "can be built"
    line = wrong[: wrong.rindex("timr_callback")].count("\n") + 1
    assert_says(row["hint"], f"cy.cpp was not built; cy.cpp:{line}: ", "timr_callback")


@pytest.mark.parametrize("missing", ["c++", "cmake", "make", "liblcm"])
def test_what_is_missing_to_build_a_program_is_said_in_its_row(missing, cli, tmp_path, monkeypatch):
    source = tmp_path / "moving_robot.cpp"
    source.write_text("int main() {}")
    monkeypatch.setattr(shutil, "which", lambda name: None if name == missing else f"/bin/{name}")
    monkeypatch.setattr(cpp, "find_spec", lambda _: None)
    monkeypatch.setattr(cpp, "_pkg_config_flags", lambda _: ())
    result = cli("lab", "check", "dolly", "--mover", str(source))
    assert result.code == 1
    assert_says(result.out, "can be built", missing, "sudo apt install ", "0 of 1")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("int main() { return x; }", "a.cpp:1: .x. was not declared"),
        ('#include "no.hpp"\nint main() {}', "a.cpp:1: no.hpp: No such file"),
        ("#include <ros/ros.h>\nint main() {}", "as in ROS; here it is <lcmtools/node.hpp>"),
        ("void f(); int main() { f(); }", "undefined reference to .f"),
        ("int f() {}", "undefined reference to .main"),
        ("#error \xe5\nint main() {}", "a.cpp:1: #error"),
    ],
)
def test_a_source_that_is_not_built_tells_the_first_error(text, error, compiler, tmp_path):
    assert compiler
    shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    source = tmp_path / "a.cpp"
    source.write_text(text, "latin-1")
    with (
        pytest.raises(LcmtoolsError, match=f"a.cpp was not built; .*{error}"),
        built_source(source),
    ):
        pass


def test_a_source_is_built_with_its_parts(compiler, tmp_path):
    """Of files beside it, those that it includes; others may be unfinished."""
    assert compiler
    shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    texts = {
        "a b.cpp": '#include "lib/pid.hpp"\nint main() { return pid(); }',
        "lib/pid.hpp": '#include <std_msgs/Int32.hpp>\n#include "deep.h"\nint pid();',
        "lib/pid.cpp": '#include "pid.hpp"\nint pid() { return deep() - std_msgs::Int32{2}.data; }',
        "lib/deep.h": "int deep();",
        "lib/deep.cc": '#include "deep.h"\n#include "more.cpp"\nint deep() { return more; }',
        "lib/more.cpp": "int more = 2;",
        "unfinished.cpp": "int pid( {",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    with built_source(tmp_path / "a b.cpp") as program:
        assert subprocess.run([program], check=False).returncode == 0


def test_the_talker_is_heard_by_the_listener(compile_program, cli, start, bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    programs = {name: compile_program(answer(name)) for name in ("listener", "talker")}
    listener = start(str(programs["listener"]))
    start(str(programs["talker"]), "__name:=mine")
    assert "[/listener]: I heard: [hello world " in listener.wait_for("I heard")
    assert cli("node", "list").out == "/listener\n/mine\n"
