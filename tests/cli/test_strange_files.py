"""Devices and pipes in the place of a file that a user names: refused at once, in one line."""

import os
import resource
from contextlib import ExitStack
from pathlib import Path

import pytest
from fixtures.limits import as_an_ordinary_user, cpu_limit

from lcmtools.errors import InvalidFile
from lcmtools.folders import LARGEST, read_bytes, read_text
from lcmtools.labs.checks.submissions import copy_submission
from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS

_MEMORY = 1 << 30  # bytes more than the process has


@pytest.fixture(autouse=True)
def _little_memory():
    before = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + _MEMORY, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


KINDS = (
    *("/dev/zero", "a pipe", "a pipe with a writer", "a large file"),
    *("a directory", "an unreadable file", "no file"),
)


@pytest.fixture(params=KINDS)
def strange(request, tmp_path):
    """A path of which nothing can be read, or no end."""
    path = tmp_path / "strange.yaml"
    kind = request.param
    with ExitStack() as stack:
        if kind == "/dev/zero":
            path.symlink_to("/dev/zero")
        elif kind == "a large file":
            path.touch()
            os.truncate(path, 1 << 40)
        elif kind == "a directory":
            path.mkdir()
        elif kind == "an unreadable file":
            path.touch(0)
            stack.enter_context(as_an_ordinary_user())
        elif kind != "no file":
            os.mkfifo(path)
            if "writer" in kind:
                stack.callback(os.close, os.open(path, os.O_RDWR))
        yield path


COMMANDS = {
    "contract": ("bag", "check", "{place}/a.lcmlog", "--against", "{path}"),
    "evidence": ("wtf", "--from", "{path}"),
    "parameters": ("param", "load", "{path}", "/a", "--timeout", "0.1"),
    "launch file": ("launch", "{path}"),
    "include": ("launch", "{place}/include.launch"),
    "rosparam": ("launch", "{place}/rosparam.launch"),
    "textfile": ("launch", "{place}/textfile.launch"),
    "world": ("run", "sim", "{path}"),
    "bag": ("bag", "import", "{path}", "{path}.lcmlog"),
    "settings": ("list",),
    "log": ("bag", "info", "{path}"),
    "log as a bus": ("echo", "--lcm-url", "file://{path}", "/a"),
    "Zenoh's configuration": ("list", "--lcm-url", "zenoh://{path}"),
    "Zenoh's certificates": ("list", "--lcm-url", "zenoh://{place}/zenoh.json5"),
    "submission": ("lab", "check", "dolly", "--programs", "{place}/class"),
}
FINE = {
    ("settings", "no file"),
    ("submission", "a directory"),
    ("log", "a pipe"),
    ("log", "a pipe with a writer"),
}
"""Cases that are no mistake, or wait for a writer as ``cat`` does."""


REASONS = (
    *("not a file", "bytes", "directory", "Permission denied", "No such file"),
    *("neither a", "no Zenoh router", "no launch file", "not a launch file", "not a ROS 2 bag"),
    *("not an LCM log", "Cannot allocate memory", "leads nowhere"),
)


CASES = [(command, kind) for command in COMMANDS for kind in KINDS if (command, kind) not in FINE]
FILES = {
    "include.launch": '<launch><include file="{path}"/></launch>',
    "rosparam.launch": '<launch><rosparam file="{path}"/></launch>',
    "textfile.launch": '<launch><param name="a" textfile="{path}"/></launch>',
    "zenoh.json5": '{{mode: "client", connect: {{endpoints: ["tls/127.0.0.1:1"]}},'
    ' transport: {{link: {{tls: {{root_ca_certificate: "{path}"}}}}}}}}',
}


@pytest.mark.parametrize(("command", "strange"), CASES, indirect=["strange"])
def test_it_is_refused_in_one_line(command, strange, cli, tmp_path, bus_url):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text.format(path=strange))
    (tmp_path / "a.lcmlog").touch()
    env = {"LCM_DEFAULT_URL": bus_url}
    for folder, name in (
        ("config/lcmtools", "config.yaml"),
        ("class", "a.py"),
    ):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / name).symlink_to(strange)
    if command == "settings":
        env["XDG_CONFIG_HOME"] = str(tmp_path / "config")
    words = (word.format(path=strange, place=tmp_path) for word in COMMANDS[command])
    with cpu_limit():
        result = cli(*words, env=env)
    assert result.code, result
    reasons = [line for line in result.err.splitlines() if any(one in line for one in REASONS)]
    assert len(reasons) == 1, result
    assert "a fault of lcmtools" not in result.err, result


@pytest.mark.parametrize("strange", [one for one in KINDS if one != "a directory"], indirect=True)
def test_a_type_is_refused_in_one_line(strange, tmp_path):
    environment = {"LCMTOOLS_TYPE_PATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    (tmp_path / "Own.lcm").symlink_to(strange)
    source = UserTypes(environment, [], FINGERPRINTS).workspace()
    assert source
    (problem,) = source.problems
    assert any(one in str(problem.error()) for one in REASONS)


def test_a_pipe_within_a_submission_is_left_out(tmp_path):
    submission, own = tmp_path / "a", tmp_path / "own"
    submission.mkdir()
    os.mkfifo(submission / "pipe")
    (submission / "a.py").touch()
    (submission / "link").symlink_to("a.py")
    copy_submission(submission, own)
    assert sorted(path.name for path in own.iterdir()) == ["a.py", "link"]


def test_a_file_may_have_so_many_bytes_and_a_shells_pipe_is_read(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(bytes(LARGEST))
    assert len(read_bytes(path)) == LARGEST
    path.write_bytes(bytes(LARGEST + 1))
    with pytest.raises(InvalidFile, match="it has more than 1000000 bytes"):
        read_bytes(path)
    reader, writer = os.pipe()
    os.write(writer, b"text")
    os.close(writer)
    assert read_text(Path(f"/dev/fd/{reader}")) == "text"
    os.close(reader)
    with pytest.raises(InvalidFile, match=r"cannot read .*: Is a directory"):
        read_bytes(tmp_path)
