"""Types of one's own, in every command: LCMTOOLS_TYPE_PATH, and code for other languages."""

import json
import marshal
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from fixtures.says import assert_line

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "plain_lcm"
POSE = "package fleet;\nstruct Pose { geometry_msgs.Point at; Tag tag; }\n"
TAG = "package fleet;\nstruct Tag { int32_t n; string words[n]; }\n"
CALL = "package fleet;\nstruct Go_Request { double x; }\nstruct Go_Response { boolean ok; }\n"


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path, tmp_path_factory):
    """A folder with types, on LCMTOOLS_TYPE_PATH."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
    for name, text in (("fleet/Pose.lcm", POSE), ("deep/er/Tag.lcm", TAG), ("Go.lcm", CALL)):
        path = tmp_path / "types" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path / "types"))
    return tmp_path / "types"


def test_every_command_for_types_knows_them(cli):
    assert "fleet/Pose" in cli("msg", "list").out.splitlines()
    assert cli("msg", "package", "fleet").out.count("\n") == 4
    shown = cli("msg", "show", "fleet.Pose").out
    assert shown.endswith("  float64 z\nfleet/Tag tag\n  string[] words\n")
    assert cli("msg", "proto", "fleet/Tag").out == "words: []\n"
    assert "fleet/Tag: string[] words" in cli("msg", "find-field", "words").out
    assert "fleet/Go" in cli("srv", "list").out.splitlines()
    assert cli("srv", "show", "fleet/Go").out == "float64 x\n---\nbool ok\n"
    number = cli("msg", "fingerprint", "fleet/Tag").out.strip()
    record = json.loads(cli("msg", "show", "--json", "fleet/Tag").out)
    assert record["fingerprint"] == f"0x{number}"


def test_they_are_published_and_seen(start, cli, lcmtools_path, bus_url):
    at = ("--lcm-url", bus_url)
    echo = start(lcmtools_path, "echo", "/p", *at)
    value = "{at: [1, 2, 3], tag: {words: [a, b]}}"
    pub = start(lcmtools_path, "pub", "-r", "20", "/p", "fleet/Pose", value, *at)
    echo.wait_for("words:")
    assert "/p [fleet/Pose]" in cli("list", "-v", *at).out
    assert cli("find", "fleet/Pose", *at).out == "/p\n"
    heard = cli("echo", "-n", "1", "/p/tag/words[1]", *at).out
    assert "b" in heard
    pub.send_signal(2)


def test_a_plain_program_is_known_by_its_fingerprint(start_python, cli, bus_url, folder):
    made = cli("msg", "generate", "--lang", "python", str(folder.parent / "gen"), "fleet/Tag")
    assert made.code == 0
    source = (
        "import time, lcm\nfrom fleet import Tag\nbus, tag = lcm.LCM(), Tag()\n"
        "tag.n, tag.words = 1, ['plain']\n"
        "while True:\n    bus.publish('TAGS', tag.encode())\n    time.sleep(0.05)\n"
    )
    start_python(source, LCM_DEFAULT_URL=bus_url, PYTHONPATH=str(folder.parent / "gen"))
    heard = cli("echo", "-n", "1", "TAGS", "--lcm-url", bus_url)
    assert "plain" in heard.out
    assert heard.code == 0


def test_scripts_get_them_by_name(folder):
    source = "import lcmtools; print(lcmtools.message_class('fleet/Pose')().at.x)"
    done = subprocess.run(
        [sys.executable, "-c", source], capture_output=True, text=True, check=False, cwd=folder
    )
    assert (done.stdout, done.stderr) == ("0.0\n", "")


def test_commands_that_start_at_once_all_get_the_same(start, lcmtools_path, folder):
    """With enough files for the cache, which none of them finds."""
    for n in range(70):
        text = f"package fleet;\nstruct T{n} {{ Tag tag; double x[{n + 1}]; }}\n"
        (folder / f"T{n}.lcm").write_text(text)
    programs = [start(lcmtools_path, "msg", "list", "--json") for _ in range(6)]
    assert {program.wait() for program in programs} == {0}
    assert len({program.output for program in programs}) == 1
    assert "fleet/T69" in programs[0].output
    kept = Path(os.environ["XDG_CACHE_HOME"]) / "lcmtools"
    assert [path.name for path in kept.iterdir()] == ["types.parsed"]
    _, parsed = marshal.loads((kept / "types.parsed").read_bytes())  # noqa: S302 - of this test
    assert len(parsed) == 3 + 70, "whole, and of all files"


def test_types_of_an_installed_package_are_known_everywhere(
    lcmtools_process, tmp_path, monkeypatch
):
    site = tmp_path / "site"
    metadata = site / "lab_types-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: lab_types\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[lcmtools.messages]\nlab = lab_types.msg\n")
    (site / "lab_types" / "msg").mkdir(parents=True)
    (site / "lab_types" / "__init__.py").write_text("raise SystemExit('nobody imports this')\n")
    (site / "lab_types" / "msg" / "Far.lcm").write_text(
        "package lab_types;\r\nstruct Far { std_msgs.Header header; }\r\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(site))
    assert "lab_types/Far" in lcmtools_process("msg", "list").stdout.splitlines()
    assert lcmtools_process("msg", "show", "lab_types/Far").stdout.startswith(
        "std_msgs/Header header\n"
    )
    made = "package fleet;\nstruct Uses { lab_types.Far far; }\n"
    (tmp_path / "types" / "Uses.lcm").write_text(made)
    shown = lcmtools_process("msg", "show", "fleet/Uses")
    file = tmp_path / "types" / "Uses.lcm"
    assert_line(shown.stderr, "ROS; -r", str(file))
    assert shown.stdout.startswith("lab_types/Far far\n")


def test_nothing_is_compiled_for_a_command_that_needs_no_type(cli, bus_url):
    assert cli("list", "--lcm-url", bus_url).code == 0
    assert list(Path(os.environ["XDG_CACHE_HOME"]).iterdir()) == []


@pytest.mark.parametrize(
    ("language", "file"),
    [
        ("c", "fleet_Pose.c"),
        ("cpp", "fleet/Pose.hpp"),
        ("java", "fleet/Pose.java"),
        ("python", "fleet/Pose.py"),
    ],
)
def test_code_is_written_with_what_types_are_made_of(language, file, cli, tmp_path):
    target = tmp_path / "gen"
    for name in ("fleet/Pose", "fleet/Go_Request"):  # the second run keeps what the first made
        done = cli("msg", "generate", "--lang", language, str(target), name)
        assert done.code == 0
        assert all(Path(line).is_file() for line in done.out.splitlines())
    assert (target / file).is_file()
    point = file.replace("fleet", "geometry_msgs").replace("Pose", "Point")
    assert (target / point).is_file()
    if language == "python":
        assert "Pose" in (target / "fleet" / "__init__.py").read_text()
        assert "Go_Request" in (target / "fleet" / "__init__.py").read_text()


def test_code_of_a_broken_file_is_not_begun(cli, tmp_path, folder):
    (folder / "fleet" / "Pose.lcm").write_text("package fleet;\nstruct Pose {\n Tag t }\n")
    done = cli("msg", "generate", "--lang", "c", str(tmp_path / "gen"), "fleet/Pose")
    assert (done.code, done.out) == (2, "")
    assert f"{folder}/fleet/Pose.lcm:3: expected token ;" in done.err
    assert not (tmp_path / "gen").exists()


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """The example's folder, built."""
    headers = Path(sysconfig.get_path("purelib")) / "include" / "lcm" / "lcm.h"
    missing = [tool for tool in ("make", "cc", "c++") if shutil.which(tool) is None]
    if missing or not headers.exists():
        pytest.skip(f"not here: {', '.join(missing) or 'the headers of LCM'}")
    folder = tmp_path_factory.mktemp("example") / "plain_lcm"
    shutil.copytree(
        EXAMPLE, folder, ignore=shutil.ignore_patterns("generated", "talker", "listener")
    )
    path = f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    command = ["make", f"PYTHON={sys.executable}", "CXX=c++"]
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stderr
    return folder


def test_node_in_cpp_talks_with_lcmtools(programs, start, cli, bus_url):
    start(str(programs / "talker"), LCM_DEFAULT_URL=bus_url).wait_for("hello world")
    at = ("--lcm-url", bus_url)
    heard = cli("echo", "-n", "1", "/chatter", *at).out
    assert heard.startswith('data: "hello world ')
    assert " * /chatter [std_msgs/String] 1 publisher\n" in cli("list", "-v", *at).out


def test_node_in_c_hears_lcmtools(programs, start, lcmtools_path, bus_url):
    listener = start(str(programs / "listener"), LCM_DEFAULT_URL=bus_url)
    listener.wait_for("listening")
    words = ("pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist", "{linear: [0.5, 0, 0]}")
    start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url)
    listener.wait_for("/cmd_vel: 0.50 m/s forward, 0.00 rad/s")
