"""Outputs that a user names: only files are replaced; what is no file is written to, or refused."""

import gc
import json
import os
import socket
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from fixtures.limits import small_files
from fixtures.says import assert_says

from lcmtools.bag.series import LogSeries
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.errors import LcmtoolsError
from lcmtools.folders import write_atomically, write_whole
from lcmtools.messages.codec import encode
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.packet import Packet

_START = 1_795_384_180 * 10**9
_COMMANDS = {
    "jsonl": "bag export in.lcmlog {} --format jsonl",
    "csv": "bag export in.lcmlog {} --format csv",
    "npz": "bag export in.lcmlog {} --format npz",
    "mcap": "bag export in.lcmlog {} --format mcap",
    "ros1": "bag export in.lcmlog {} --format ros1",
    "filter": "bag filter in.lcmlog {}",
    "cut": "bag cut in.lcmlog {} -s 1s",
    "downsample": "bag downsample in.lcmlog {} --every 2",
    "merge": "bag merge in.lcmlog -o {}",
    "sort": "bag sort in.lcmlog {}",
    "fix": "bag fix in.lcmlog {}",
    "rename": "bag rename in.lcmlog {} /a:=/b",
    "shift": "bag shift in.lcmlog {} --by 1s",
    "graph": "graph -b in.lcmlog --format dot -o {}",
    "evidence": "wtf -b in.lcmlog --save {}",
}
_WAYS = ("csv", "mcap", "sort", "graph", "evidence")
"""One command of each way of writing."""
_SAVING = ("evidence",)  # which replaces its own file without being asked


def _words(name, target):
    force = [] if name in _SAVING else ["--force"]
    return [*_COMMANDS[name].format(target).split(), *force]


@pytest.fixture(autouse=True)
def _log(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with LogWriter("in.lcmlog") as log:
        for number in range(10):
            payload = encode(Float64(data=float(number)))
            log.add(Packet("/a", payload, _START + number * 10**9))


@pytest.fixture
def pipe(tmp_path):
    """A named pipe ``pipe``, and what is written to it."""
    os.mkfifo(tmp_path / "pipe")
    content = []
    reader = threading.Thread(target=lambda: content.append(Path("pipe").read_bytes()))
    reader.start()

    def read():
        reader.join(20)
        return content[0]

    yield read
    if reader.is_alive():  # nobody has written
        os.close(os.open("pipe", os.O_WRONLY))
        reader.join()


@pytest.mark.parametrize("name", _COMMANDS)
def test_a_pipe_gets_the_content_and_stays(name, pipe):
    assert main(_words(name, "made" if name != "csv" else "made.csv")) == 0
    assert main(_words(name, "pipe")) == 0
    assert stat.S_ISFIFO(Path("pipe").stat().st_mode)
    got, made = pipe(), Path("made" if name != "csv" else "made.csv").read_bytes()
    assert got
    if name not in ("npz", "mcap", "ros1", "evidence"):  # which hold the time of their making
        assert got == made
    assert not list(Path().glob("*pipe.index"))


@pytest.mark.parametrize("name", _WAYS)
def test_a_device_is_not_replaced(name):
    Path("device").symlink_to("/dev/null")
    assert main(_words(name, "device")) == 0
    assert Path("device").is_symlink()
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize(
    "command", [*map(_COMMANDS.get, _WAYS), "bag export in.lcmlog {} --format ros2"]
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # rosbags' file
def test_a_full_disk_is_told_with_the_name_of_the_target(command, capsys):
    target = "made.csv"
    with small_files(most=150):
        assert main(command.format(target).split()) in (1, 64)
        gc.collect()
    assert f"cannot write {target}: " in capsys.readouterr().err
    assert not list(Path().glob("*made*"))


@pytest.mark.parametrize("name", _WAYS)
def test_a_link_stays_and_the_file_that_it_leads_to_is_replaced(name):
    Path("below").mkdir()
    target = Path("below/target.csv")
    target.write_text("mine")
    target.chmod(0o640)
    Path("link.csv").symlink_to(target)
    if name not in _SAVING:
        assert main(_words(name, "link.csv")[:-1]) in (1, 2)  # without --force
        assert target.read_text() == "mine"
    assert main(_words(name, "link.csv")) == 0
    assert Path("link.csv").is_symlink()
    assert b"mine" not in target.read_bytes()[:4]
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    if name == "sort":
        with LogFile("link.csv") as log:
            assert log.index.blocks


@pytest.mark.parametrize("name", _WAYS)
def test_a_socket_is_refused_without_advising_force(name, capsys):
    with socket.socket(socket.AF_UNIX) as end:
        end.bind("socket")
        assert main(_words(name, "socket")) in (1, 64)
        assert_says(capsys.readouterr().err, "socket is neither a file nor a pipe; name another\n")
        assert Path("socket").is_socket()


@pytest.mark.parametrize(
    ("name", "target"), [*((name, "-") for name in _COMMANDS), ("sort", "/dev/stdout")]
)
def test_standard_output_gets_the_content_alone(name, target, capfdbinary):
    assert main(_words(name, target)) == 0
    out = capfdbinary.readouterr().out
    starts = {"jsonl": b'{"topic"', "csv": b"%time", "npz": b"PK", "mcap": b"\x89MCAP"}
    starts |= {"ros1": b"#ROSBAG", "graph": b"digraph", "evidence": b'{"lcmtools_evidence"'}
    assert out.startswith(starts.get(name, b"\xed\xa1\xda\x01"))
    if name == "evidence":
        assert json.loads(out)
    assert not [one for one in Path().iterdir() if one.name.startswith("-")]


def test_a_terminal_gets_no_binary_data():
    script = "import os, pty, sys\nsys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))"
    words = [sys.executable, "-c", script, sys.executable, "-m", "lcmtools"]
    for command, code in (("bag sort in.lcmlog -", 1), ("bag export in.lcmlog - --format csv", 0)):
        done = subprocess.run(
            [*words, *command.split()], capture_output=True, stdin=subprocess.DEVNULL, check=False
        )
        assert done.returncode == code, done
        assert (b"it is a terminal; name a file" in done.stdout) == bool(code)


def test_a_folder_of_files_is_no_stream(capsys):
    assert main(["bag", "export", "in.lcmlog", "-", "--format", "ros2"]) == 2
    assert_says(
        capsys.readouterr().err, "a bag of ROS 2 is a folder, which - cannot be; name a folder"
    )


def test_a_recording_goes_into_a_pipe(pipe, tmp_path):
    series = LogSeries("pipe", force=True)
    with series.next() as writer:
        writer.add(Packet("/a", bytes(8), _START))
    Path("got.lcmlog").write_bytes(pipe())
    with LogFile("got.lcmlog") as log:
        assert [one.channel for one in log.packets()] == ["/a"]
    assert not (tmp_path / "pipe.index").exists()
    with pytest.raises(LcmtoolsError, match="pipe is no file, and is not split; leave out --split"):
        LogSeries("pipe", numbered=True).next()


def test_settings_that_lead_to_a_device_do_not_replace_it():
    Path("settings").symlink_to("/dev/null")
    write_atomically(Path("settings"), "text")
    write_whole(Path("settings"), b"bytes")
    assert Path("/dev/null").is_char_device()
