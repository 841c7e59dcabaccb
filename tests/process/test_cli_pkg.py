"""pkg, and run for packages: what a student does, from an empty folder on."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fixtures.says import assert_line, assert_says

Run = Callable[..., Any]

CREATE = ("pkg", "create", "air_lab0", "--node", "simple_controller")
NAMES = ("--deps", "nav_msgs", "geometry_msgs", "--msg", "Stat")


@pytest.fixture(autouse=True)
def _own_cache(monkeypatch, tmp_path_factory):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture
def space(tmp_path, monkeypatch, cli):
    """A workspace, which is the current folder, with the package air_lab0."""
    folder = tmp_path / "space"
    folder.mkdir()
    monkeypatch.chdir(folder)
    made = cli(*CREATE, *NAMES)
    assert made.code == 0
    noted, following = made.err.splitlines()
    assert_says(noted, f"{folder} is noted as a workspace, a folder with packages")
    assert following == "next: lcmtools run air_lab0 simple_controller"
    assert all((folder / line).is_file() for line in made.out.splitlines())
    return folder


def test_new_package_runs_without_being_installed(space, start, cli, lcmtools_path, bus_url):
    words = ["__ns:=/husky0", "odometry:=/other/odometry"]
    shell = ["sh", "-c", f'cd {space} && exec "$0" run air_lab0 simple_controller "$@"']
    node = start(*shell, lcmtools_path, *words, LCM_DEFAULT_URL=bus_url)
    node.wait_for("[/husky0/simple_controller]: 0 messages on odometry so far")
    info = cli("node", "info", "/husky0/simple_controller", "--lcm-url", bus_url).out
    assert " * /husky0/count [air_lab0/Stat]\n" in info
    assert " * /other/odometry [nav_msgs/Odometry]\n" in info
    echo = cli("echo", "-n", "1", "/husky0/count", "--lcm-url", bus_url)
    assert (echo.out, echo.err) == ("count: 0\nperiod: 0.0\n---\n", "")


def test_its_script_is_run_by_python_as_well(space, start, cli, bus_url):
    script = space / "air_lab0" / "air_lab0" / "simple_controller.py"
    words = ["__ns:=/husky0", "__name:=mine", "odometry:=a"]
    start(sys.executable, str(script), *words, LCM_DEFAULT_URL=bus_url).wait_for("[/husky0/mine]")
    info = cli("node", "info", "/husky0/mine", "--lcm-url", bus_url).out
    assert " * /husky0/a [nav_msgs/Odometry]\n" in info
    assert " * /husky0/count [air_lab0/Stat]\n" in info


def test_new_package_is_found_from_a_new_terminal(
    space, start, lcmtools_path, bus_url, cli,
    monkeypatch
):  # fmt: skip
    shell = ["sh", "-c", 'cd / && exec "$0" run air_lab0 simple_controller', lcmtools_path]
    node = start(*shell, LCM_DEFAULT_URL=bus_url)
    node.wait_for("[/simple_controller]: 0 messages on odometry so far")
    monkeypatch.chdir("/")
    assert cli("pkg", "find", "air_lab0").out == f"{space}/air_lab0\n"
    assert cli("msg", "show", "air_lab0/Stat").out.startswith("int32 count\n")
    assert cli("pkg", "build").err.endswith("ready: air_lab0\n")
    added = cli("pkg", "add-node", "watcher")
    assert_line(added.err, "next: lcmtools run air_lab0 watcher\n")
    both = cli("pkg", "create", "other", str(space / "x" / ".."))
    assert_line(both.err, "next: lcmtools run other other_node\n")


def test_package_that_is_not_noted_is_found_from_its_workspace(space, cli):
    made = cli("pkg", "create", "other", "more", env={"LCMTOOLS_PACKAGE_PATH": str(space)})
    reason, following = made.err.splitlines()
    where = f"the package is found only from {space}/more, which is not in LCMTOOLS_PACKAGE_PATH"
    assert (reason, following) == (where, "next: cd more; lcmtools run other other_node")
    (space / "settings").write_text("")
    made = cli("pkg", "create", "third", env={"XDG_CONFIG_HOME": f"{space}/settings"})
    assert made.code == 0
    assert_says(made.err, f"cannot write {space}/settings/lcmtools/workspaces: ", "only from")


SCRIPT = """\
#!/usr/bin/env python
import os
import sys

print(os.environ["LCM_DEFAULT_URL"], *sys.argv[1:])
sys.exit(7)
"""


@pytest.mark.parametrize(
    ("here", "words"),
    [
        (".", "rosrun air_lab0 evaluate_controller.py"),
        (".", "run air_lab0 evaluate_controller"),
        ("air_lab0", "run ./src/evaluate_controller.py"),
        ("air_lab0/src", "run evaluate_controller.py"),
    ],
)
def test_a_script_is_run_by_its_name_or_path(space, lcmtools_path, here, words):
    script = space / "air_lab0" / "src" / "evaluate_controller.py"
    script.parent.mkdir(exist_ok=True)
    script.write_text(SCRIPT)
    script.chmod(0o744)
    command = [lcmtools_path, "--domain", "3", *words.split(), "__ns:=/husky0", "--", "-v"]
    done = subprocess.run(
        command, cwd=space / here, env={**os.environ, "LCM_DEFAULT_URL": "udpm://239.255.76.67:1"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    said = "udpm://239.255.76.67:7670?ttl=0 __ns:=/husky0 -- -v\n"
    assert (done.returncode, done.stdout) == (7, said), done.stderr


def test_a_file_that_cannot_be_run_is_named(space, cli):
    script = space / "air_lab0" / "src" / "evaluate_controller.py"
    script.parent.mkdir(exist_ok=True)
    script.write_text(SCRIPT)
    done = cli("run", "air_lab0", "evaluate_controller.py")
    path = "air_lab0/src/evaluate_controller.py"
    assert done.code == 2
    assert_line(done.err, f"lcmtools run: {path} is not executable; type: chmod +x {path}\n")
    (space / "drive").touch()
    assert_line(cli("run", "./drive").err, "drive is not executable; type: chmod +x ")
    assert_line(cli("run", "./driv").err, "there is no file './driv'")
    assert_line(cli("run", "./air_lab0").err, "there is no file './air_lab0'")


def test_its_test_passes(space):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=space / "air_lab0",
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, "1 passed" in done.stdout) == (0, True), done.stdout + done.stderr


def test_its_launch_file_says_which_node_runs(space, cli):
    shown = cli("launch", str(space / "air_lab0/launch/simple_controller.yaml"), "--nodes")
    assert (shown.code, shown.out) == (0, "/simple_controller\n")


def test_messages_are_imported_as_in_ros(space):
    source = "from air_lab0.msg import Stat\nprint(Stat().period)\nfrom air_lab0.msg import Stats\n"
    done = subprocess.run(
        [sys.executable, "-c", source],
        cwd="/",
        env={**os.environ, "PYTHONPATH": str(space / "air_lab0")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "0.0\n"
    assert "ImportError: cannot import name 'Stats' from 'air_lab0.msg'" in done.stderr


@pytest.mark.usefixtures("space")
def test_packages_and_their_nodes_are_listed(cli):
    assert cli("run", "air_lab0").out.startswith("simple_controller ")
    assert "\nlistener " in cli("run", "--list").out
    names = json.loads(cli("run", "--list", "--json").out)
    assert {"air_lab0 simple_controller", "talker"} <= set(names)
    found = {one["name"]: one for one in json.loads(cli("pkg", "list", "--json").out)}
    assert found["air_lab0"]["nodes"] == ["simple_controller"]
    assert found["lcmtools"]["is_installed"]
    folder = str(Path.cwd() / "air_lab0")
    assert cli("pkg", "list").out.splitlines()[0].split() == ["air_lab0", folder]
    assert cli("pkg", "find", "air_lab0").out == f"{folder}\n"
    assert cli("pkg", "prefix", "air_lab").err.endswith("did you mean air_lab0?\n")


@pytest.mark.usefixtures("space")
def test_build_says_what_was_made_and_what_is_wrong(space, cli):
    file = "air_lab0/air_lab0/msg/Stat.lcm"
    made = cli("pkg", "build")
    assert made.out == f"air_lab0/Stat  {file}\n"
    assert (made.code, made.err) == (0, "ready: air_lab0\n")
    (space / file).write_text("package air_lab0;\nstruct Stat\n{\n  double x\n}\n")
    failed = cli("pkg", "build", "air_lab0")
    said = f"{file}:5: expected token ;; a ';' is missing before this\n"
    assert (failed.code, failed.out) == (1, "")
    assert failed.err == f"lcmtools pkg build: {said}"
    assert cli("msg", "show", "air_lab0/Stat").err == f"lcmtools msg show: {said}"
    listed = cli("msg", "list")
    assert (listed.code, listed.err) == (0, f"lcmtools msg list: {said}")
    record = json.loads(cli("msg", "build", "--json").out)
    assert (record["types"], record["problems"][0]["line"]) == ([], 5)


ROS_NODE = """
import lcmtools
from air_lab0.msg import ControllerEvaluationStat
from air_lab0.srv import Reset


def main(args=None):
    lcmtools.init(args)
    node = lcmtools.Node("evaluate")
    stat = node.create_publisher(ControllerEvaluationStat, "stat")
    node.create_service(Reset, "reset", lambda request, response: response)
    message = ControllerEvaluationStat()
    message.samples = 3
    node.create_timer(0.05, lambda: stat.publish(message))
    lcmtools.spin(node)
"""


def test_ros_message_files_of_a_package_are_used_as_they_are(
    space, start, cli, lcmtools_path, bus_url
):
    root = space / "air_lab0"
    for name, text in (
        (
            "msg/ControllerEvaluationStat.msg",
            "Header header\nuint32 samples # all\nfloat64 error\n",
        ),
        ("srv/Reset.srv", "float64 x\n---\nbool ok\n"),
    ):
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_text(text)
    (root / "air_lab0" / "simple_controller.py").write_text(ROS_NODE)
    built = cli("pkg", "build")
    assert "air_lab0/ControllerEvaluationStat  air_lab0/msg/Controller" in built.out
    assert built.err == "ready: air_lab0\n"
    shown = cli("msg", "show", "-r", "air_lab0/ControllerEvaluationStat")
    assert shown.out == "Header header\nuint32 samples # all\nfloat64 error\n"
    said = "types are spelt as in ROS; this is air_lab0/msg/ControllerEvaluationStat.msg\n"
    assert shown.err == said
    assert cli("srv", "show", "-r", "air_lab0/Reset").out == "float64 x\n---\nbool ok\n"
    at = ("--lcm-url", bus_url)
    here = ["sh", "-c", f'cd {space} && exec "$0" "$@"', lcmtools_path]
    echo = start(*here, "echo", "/stat", *at)
    pub = start(*here, "pub", "-r", "20", "/stat", "ControllerEvaluationStat", "error: 7", *at)
    echo.wait_for("error: 7")
    pub.end()
    start(*here, "run", "air_lab0", "simple_controller", *at)
    echo.wait_for("samples: 3")
    called = cli("service", "call", "/reset", "{x: 1}", *at)
    assert (called.code, "ok: False" in called.out) == (0, True), called.err


IMPORTING = """
import air_lab0.msg
import nav_msgs.msg
import sensor_msgs.msg as sensors
from air_lab0.msg import ControllerEvaluationStat
from other.msg import Thing
from std_msgs.msg import *
from std_srvs.srv import SetBool


def main(args=None):
    assert air_lab0.msg.ControllerEvaluationStat is ControllerEvaluationStat
    print(nav_msgs.msg.MapMetaData(width=3).width, sensors.Joy(axes=[0.5]).axes)
    print(String(data="star"), Thing(x=1.5), SetBool.Request(data=True))
    print(air_lab0.msg.ControllerEvaluationStat(), hasattr(air_lab0.msg, "Nothing"))
"""
IMPORTED = """\
3 [0.5]
String(data='star') Thing(x=1.5) SetBool_Request(data=True)
ControllerEvaluationStat(error=0.0) False
"""


@pytest.mark.parametrize("code", ["package.msg", "folder", "none"])
def test_a_node_imports_types_as_in_ros(code, space, cli):
    package = space / "air_lab0"
    (package / "air_lab0" / "simple_controller.py").write_text(IMPORTING)
    (space / "other" / "msg").mkdir(parents=True)
    (space / "other" / "package.xml").write_text("<package><name>other</name></package>")
    (space / "other" / "msg" / "Thing.msg").write_text("float64 x\n")
    types = package / "air_lab0" / "msg" if code != "none" else package / "msg"
    types.mkdir(exist_ok=True)
    (types / "ControllerEvaluationStat.msg").write_text("float64 error\n")
    if code == "package.msg":
        (types / "__init__.py").write_text(
            "from lcmtools.packages.user_types import package_messages\n"
            "__getattr__ = package_messages(__name__, __file__)\n"
        )
    done = cli("run", "air_lab0", "simple_controller")
    assert (done.code, done.out) == (0, IMPORTED), done.err


@pytest.mark.parametrize(
    ("words", "first"),
    [
        ("run air_lab0 evaluate", "#!/usr/bin/env python\n"),
        ("run air_lab0/src/evaluate.py", ""),
        ("launch one.yaml", "#!/usr/bin/env python\n"),
    ],
)
def test_a_script_imports_types_as_in_ros(words, first, space, lcmtools_path, monkeypatch):
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    script = space / "air_lab0" / "src" / "evaluate.py"
    script.parent.mkdir(exist_ok=True)
    used = "print(nav_msgs.msg.Path().poses, air_lab0.msg.Progress(x=1), __name__, sys.path[0])\n"
    script.write_text(f"{first}import sys\nimport nav_msgs.msg\nimport air_lab0.msg\n{used}")
    script.chmod(0o744)
    (space / "air_lab0" / "msg").mkdir()
    (space / "air_lab0" / "msg" / "Progress.msg").write_text("int32 x\n")
    (space / "one.yaml").write_text(
        "nodes: [{run: ./air_lab0/src/evaluate.py, output: screen, required: true}]\n"
    )
    done = _run([lcmtools_path, *words.split()])
    assert f"[] Progress(x=1) __main__ {script.parent}\n" in done.stdout, done.stderr
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("import rospy\n", "evaluate.py imports 'rospy', as in ROS; here it is lcmtools: import"),
        ("def main()\n", "SyntaxError: expected ':'"),
        ("x = 3\nx.y\n", 'evaluate.py", line 2, in <module>'),
    ],
)
def test_a_fault_in_a_script_is_shown_where_it_is(source, said, space, lcmtools_path):
    (space / "evaluate.py").write_text(source)
    done = _run([lcmtools_path, "run", "./evaluate.py"])
    assert (done.returncode, said in done.stderr) == (1, True), done.stderr
    assert "lcmtools/packages" not in done.stderr
    assert "runpy" not in done.stderr


def _run(command):
    """Run a command that becomes another program, which one in this process cannot."""
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_nothing_is_overwritten(space, cli):
    node = space / "air_lab0" / "air_lab0" / "simple_controller.py"
    node.write_text("mine\n")
    again = cli(*CREATE)
    assert (again.code, again.out) == (1, "")
    parts = ("air_lab0/pyproject.toml", "exists; --force")
    assert_line(again.err, "lcmtools pkg create: ", *parts)
    assert node.read_text() == "mine\n"
    assert cli(*CREATE, "--force").code == 0
    assert node.read_text() != "mine\n"


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("def main(args=None):\n    return undefined\n", "NameError: name 'undefined' is not"),
        ("def main(args=None)\n", "SyntaxError: expected ':'"),
        (
            "from lcmtools.types.geometry_msg import Twist\n",
            "write: from lcmtools.types import geometry_msgs",
        ),
        ("x = 3\n", "has no function 'main'; write def main(args=None): in it"),
        ("import no_such_module\n", "needs the Python package 'no_such_module', which is not"),
        ("import rospy\n", "imports 'rospy', as in ROS; here it is lcmtools: import lcmtools"),
        ("import nav_msgs.messages\n", "name 'messages' from 'nav_msgs': it has msg, srv, "),
        ("import lcmtools.types.nav_msgs.msg\n", ": here it is lcmtools.types.nav_msgs\n"),
    ],
)
def test_a_fault_in_ones_own_node_is_shown_where_it_is(source, said, space, cli):
    (space / "air_lab0" / "air_lab0" / "simple_controller.py").write_text(source)
    done = cli("run", "air_lab0", "simple_controller")
    assert done.code in (1, 3)
    assert said in done.err
    assert "fault of lcmtools" not in done.err
    assert "lcmtools/cli" not in done.err


def test_a_broken_package_beside_does_not_matter_until_it_is_meant(space, cli):
    (space / "other").mkdir()
    (space / "other" / "pyproject.toml").write_text("[tool.lcmtools]\n[project\n")
    assert cli("run", "talker", "--help").code == 0
    assert cli("run", "air_lab0").out.startswith("simple_controller ")
    wrong = cli("run", "other", "go")
    assert (wrong.code, wrong.err.count("\n")) == (2, 1)
    assert_says(wrong.err, f"{space}/other/pyproject.toml:2: ", "not TOML")


def test_ones_own_node_runs_in_place_of_lcmtools_own_of_the_same_name(space, cli, monkeypatch):
    said = "def main(args=None):\n    print('mine')\n"
    (space / "air_lab0" / "air_lab0" / "simple_controller.py").write_text(said)
    for folder in (space, space / "air_lab0", space / "air_lab0" / "launch"):
        monkeypatch.chdir(folder)
        done = cli("run", "simple_controller")
        assert (done.code, done.out, done.err) == (0, "mine\n", "")


def test_lcmtools_own_answer_says_so_when_it_runs(start, lcmtools_path, bus_url, cli):
    assert cli("run", "simple_controller", "--help").err == ""
    started = start(lcmtools_path, "run", "simple_controller", LCM_DEFAULT_URL=bus_url)
    started.wait_for("this is lcmtools' own simple_controller, the lab's model answer")


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('"air_lab0.simple_controler:main"', "there is no module air_lab0.simple_controler; see"),
        (
            '"air_lab0.simple_controller:run"',
            "'run'; write def run(args=None): in it, or see [project",
        ),
        ('"air_lab0/simple_controller.py"', "is not a function; write simple_controller = "),
    ],
)
def test_a_broken_entry_point_is_said_and_lcmtools_own_not_taken(space, cli, entry, said):
    project = space / "air_lab0" / "pyproject.toml"
    right = '"air_lab0.simple_controller:main"'
    project.write_text(project.read_text().replace(right, entry))
    done = cli("run", "simple_controller")
    assert (done.code, done.err.count("\n")) == (1, 1)
    assert said in done.err


def test_a_second_node_is_added_and_runs(space, cli):
    done = cli("pkg", "add-node", "evaluator", "--skeleton", "evaluate_controller")
    assert done.code == 0
    assert_line(done.err, "lcmtools run air_lab0 evaluator\n")
    assert done.out.splitlines() == [
        "air_lab0/air_lab0/evaluator.py",
        "air_lab0/pyproject.toml",
    ]
    text = (space / "air_lab0" / "air_lab0" / "evaluator.py").read_text()
    assert "lcmtools run air_lab0 evaluator __ns:=/husky0" in text
    assert 'super().__init__("evaluator")' in text
    assert "evaluate_controller" not in text
    assert [line.split()[0] for line in cli("run", "air_lab0").out.splitlines()] == [
        "evaluator",
        "simple_controller",
    ]


@pytest.mark.parametrize("head", ["def main(args):", "def main():"])
def test_a_main_function_gets_its_words_with_and_without_a_parameter(space, cli, head):
    words = "args" if "args" in head else "sys.argv[1:]"
    text = f"import sys\n{head}\n    print({words})\n"
    (space / "air_lab0" / "air_lab0" / "simple_controller.py").write_text(text)
    done = cli("run", "air_lab0", "simple_controller", "__ns:=/a", "x")
    assert (done.out, done.err) == ("['__ns:=/a', 'x']\n", "")


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("lcmtools run air", "air_lab0"),
        ("lcmtools run air_lab0 ", "simple_controller"),
        ("lcmtools msg show air_lab0/S", "air_lab0/Stat"),
        ("lcmtools pkg create other --deps nav", "nav_msgs"),
    ],
)
@pytest.mark.usefixtures("space")
def test_packages_are_completed(line, answer, lcmtools_process, bus_url, wait_until):
    def is_completed():
        asked = lcmtools_process(line, _LCMTOOLS_COMPLETE="bash", LCM_DEFAULT_URL=bus_url)
        assert asked.stderr == ""
        return answer in asked.stdout.split()

    wait_until(is_completed)  # where the computer is busy it gives up after 2 s
