"""The records that nodes leave while they live."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from lcmtools.bus.processes import process_of
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import parse_url
from lcmtools.graph.model import Endpoint, NodeInfo, Role

_URL = parse_url("udpm://239.255.76.67:19999?ttl=0")


def _node(**changes):
    values = {"name": "/a", "id": "abc", "host": "here", "pid": os.getpid(), "start_time": 5}
    return NodeInfo(**{**values, "command": "a b", **changes})


@pytest.fixture
def records(tmp_path):
    return NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path)})


def _files(folder):
    return [path for path in folder.rglob("*") if path.is_file()]


def test_a_record_says_who_the_node_is_and_that_it_does_not_answer(records):
    records.write(_node())
    (found,) = records.read()
    assert (found.name, found.id, found.host) == ("/a", "abc", "here")
    assert (found.pid, found.start_time, found.command) == (os.getpid(), 5, "a b")
    assert found.stale == "runs but does not answer"


def test_a_removed_record_leaves_no_file(records, tmp_path):
    records.write(_node())
    assert len(_files(tmp_path)) == 1
    records.remove("abc")
    records.remove("abc")
    assert _files(tmp_path) == []
    assert list(records.read()) == []


def test_a_renewed_record_is_one_record(records):
    records.write(_node())
    records.write(_node(name="/b"))
    assert [node.name for node in records.read()] == ["/b"]


def test_the_records_of_nodes_that_have_answered_are_left_out(records):
    records.write(_node())
    records.write(_node(id="def", name="/b"))
    assert [node.name for node in records.read(but={"def"})] == ["/a"]


def test_two_nodes_of_one_process_leave_two_records(records):
    records.write(_node())
    records.write(_node(id="def", name="/b"))
    assert [node.name for node in records.read()] == ["/a", "/b"]


def test_records_of_another_bus_stay_apart(records, tmp_path):
    records.write(_node())
    other = parse_url("udpm://239.255.76.67:19998?ttl=0")
    assert list(NodeRecords(other, {"XDG_RUNTIME_DIR": str(tmp_path)}).read()) == []


@pytest.fixture
def child():
    command = [sys.executable, "-c", "import sys; print(flush=True); sys.stdin.read()"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()  # it has become what it will be
        yield process
        process.kill()


def _record_of(records, pid, folder):
    """A record as if the process of ``pid`` had written it."""
    records.write(_node(pid=pid))
    (path,) = _files(folder)
    process = process_of(pid)
    assert process is not None
    path.write_text(
        json.dumps({**json.loads(path.read_text()), "start_ticks": process.start_ticks})
    )
    return path


def test_a_killed_process_is_known_to_have_ended(records, tmp_path, child):
    _record_of(records, child.pid, tmp_path)
    assert [node.stale for node in records.read()] == ["runs but does not answer"]
    child.kill()
    child.wait()
    assert [node.stale for node in records.read()] == ["ended without saying goodbye"]


def test_a_node_that_is_started_again_takes_the_place_of_its_dead_self(records, tmp_path, child):
    _record_of(records, child.pid, tmp_path)
    child.kill()
    child.wait()
    records.write(_node(pid=os.getpid())._replace(id="another"))
    assert [node.id for node in records.read()] == ["another"]


def test_a_killed_process_that_nobody_waits_for_is_known_to_have_ended(
    records, tmp_path, child, wait_until
):
    _record_of(records, child.pid, tmp_path)
    child.kill()  # and not wait: it stays in the process table as a zombie
    wait_until(lambda: [n.stale for n in records.read()] == ["ended without saying goodbye"])


def test_another_process_with_the_same_pid_is_not_taken_for_the_node(records, tmp_path):
    path = _record_of(records, os.getpid(), tmp_path)
    path.write_text(json.dumps({**json.loads(path.read_text()), "start_ticks": 1}))
    assert [node.stale for node in records.read()] == ["ended without saying goodbye"]


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "3", "null", '"a"', "{}", '{"pid": "x"}', '{"pid": null}', "\xff"]
)
def test_a_damaged_record_is_passed_over(records, tmp_path, text):
    records.write(_node())
    (path,) = _files(tmp_path)
    path.with_name("aaa.json").write_bytes(text.encode("latin-1"))
    assert [node.name for node in records.read()] == ["/a"]


@pytest.mark.parametrize("mask", [0o002, 0o000, 0o022, 0o077])
def test_a_record_is_private_whatever_the_users_umask(tmp_path, mask):
    records = NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path)})
    before = os.umask(mask)
    try:
        records.write(_node())
    finally:
        os.umask(before)
    assert [node.name for node in records.read()] == ["/a"]
    for path in tmp_path.rglob("*"):
        assert path.is_file() or not path.stat().st_mode & 0o077, path


def test_a_folder_that_others_can_write_to_is_not_believed(tmp_path):
    records = NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path)})
    records.write(_node())
    (tmp_path / "lcmtools").chmod(0o777)
    assert list(records.read()) == []


def test_a_folder_that_is_a_link_is_not_believed(tmp_path):
    records = NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path)})
    records.write(_node())
    (tmp_path / "lcmtools").rename(tmp_path / "elsewhere")
    (tmp_path / "lcmtools").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "elsewhere").chmod(0o777)
    assert list(records.read()) == []


def _foreign(folder):
    folder.mkdir()
    os.chown(folder, 12345, 12345)


def _full(folder):
    folder.mkdir()
    (folder / "lcmtools").write_text("in the way")


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(_foreign, marks=pytest.mark.root),
        _full,
        lambda folder: folder.symlink_to(folder),
        lambda folder: folder.write_text("no folder"),
        Path.exists,
    ],
    ids=["another user's", "in the way", "unreadable", "a file", "missing"],
)
def test_a_runtime_folder_that_takes_no_records_leaves_them_to_the_second_one(tmp_path, make):
    make(tmp_path / "run")
    records = NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path / "run")})
    assert records.write(_node())
    assert [node.name for node in records.read()] == ["/a"]
    records.remove("abc")
    assert list(records.read()) == []
    assert not list(tmp_path.glob("run/lcmtools/*"))


def test_records_that_no_folder_takes_are_missed(tmp_path, monkeypatch):
    monkeypatch.setattr("os.getuid", lambda: 54321)  # whose folder nothing here can be
    records = NodeRecords(_URL, {"XDG_RUNTIME_DIR": str(tmp_path)})
    assert not records.write(_node())
    assert list(records.read()) == []
    shutil.rmtree("/tmp/lcmtools-54321")  # noqa: S108


def test_names_that_are_not_utf8_are_recorded(records):
    records.write(_node(command="run \udcff"))
    assert [node.command for node in records.read()] == ["run \udcff"]


def test_a_record_says_what_the_node_published_and_heard(records):
    ends = Endpoint("/chatter", Role.PUBLISHER), Endpoint("/news", Role.SUBSCRIBER)
    records.write(_node(endpoints=ends))
    assert records.topics({"abc"}, Role.SUBSCRIBER) == {"/news"}
    assert records.topics({"abc"}, Role.PUBLISHER) == {"/chatter"}
    assert records.topics({"def"}, Role.PUBLISHER) == set()


@pytest.mark.parametrize("number", ["network", "network_cookie"])
def test_a_node_in_another_network_is_on_another_bus(records, tmp_path, number):
    """Also in one that has gone, whose number this one has got."""
    records.write(_node())
    (file,) = _files(tmp_path)
    file.write_text(json.dumps({**json.loads(file.read_text()), number: 1}))
    assert list(records.read()) == []


def test_a_namesake_is_another_process_that_lives(records):
    records.write(_node())
    assert records.namesake(_node(id="def")) is None, "it is of this process"
    twin = records.namesake(_node(id="def", pid=1))
    assert twin
    assert twin.pid == os.getpid()
    assert records.namesake(_node(name="/b", pid=1)) is None
    records.write(_node(id="ghi", name="/c", pid=2**22 + 1))
    assert records.namesake(_node(name="/c", pid=1)) is None, "it has ended"


def test_a_node_of_another_pid_namespace_is_neither_alive_nor_ended(records, tmp_path):
    records.write(_node())
    (file,) = _files(tmp_path)
    record = json.loads(file.read_text())
    record["pid_namespace"] += 1
    file.write_text(json.dumps(record))
    assert list(records.read()) == []
    del record["pid_namespace"]  # as before version 2
    file.write_text(json.dumps(record))
    assert [node.name for node in records.read()] == ["/a"]
