"""Logs and C programs, linked with the lcm package's library: each reads what the other writes."""

import json
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest
from fixtures.says import assert_line

from lcmtools.bag.log import Log
from lcmtools.types.geometry_msgs import Twist

_PACKAGES = Path(sysconfig.get_path("purelib"))
_HERE = Path(__file__).parent
_TYPES = _HERE.parents[1] / "lcm_types/geometry_msgs"


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """The C program, with the types as lcm-gen makes them for C."""
    compiler = shutil.which("gcc") or pytest.skip("no gcc to compile C programs with")
    folder = tmp_path_factory.mktemp("c")
    sources = [_TYPES / f"{name}.lcm" for name in ("Twist", "Vector3")]
    generator = _PACKAGES / "bin/lcm-gen"
    subprocess.run([generator, "-c", *sources], cwd=folder, check=True)
    options = [f"-I{folder}", f"-I{_PACKAGES / 'include'}", f"-L{_PACKAGES / 'lib'}"]
    options += [f"-Wl,-rpath,{_PACKAGES / 'lib'}", "-llcm"]
    made = [_HERE / "programs/drive.c", *folder.glob("*.c")]
    subprocess.run([compiler, "-o", folder / "drive", *made, *options], check=True)
    return str(folder / "drive")


def test_messages_of_a_c_program_are_recorded_shown_and_played_to_another_one(
    drive, bus_url, tmp_path, start, lcmtools_path, cli
):
    path = tmp_path / "drive.lcmlog"
    words = ("-o", str(path), "-n", "20", "C_DRIVE")
    recorder = start(lcmtools_path, "bag", "record", *words, LCM_DEFAULT_URL=bus_url)
    while not path.exists():
        assert recorder._process.poll() is None
    sender = start(drive, "send", bus_url, "20")
    sender.wait_for("sent")
    assert recorder.wait() == 0
    (record,) = json.loads(cli("bag", "info", str(path), "--json").ok())
    (topic,) = record["topics"]
    assert (topic["topic"], topic["types"], topic["messages"]) == (
        "C_DRIVE",
        ["geometry_msgs/Twist", "geometry_msgs/Accel"],
        20,
    )
    (name,) = topic["senders"]
    assert name.startswith("drive")
    listener = start(drive, "listen", bus_url, "20")
    listener.wait_for("listens")
    environment = {"LCM_DEFAULT_URL": bus_url}
    cli("bag", "play", str(path), "--rate", "0", "--force", "C_DRIVE:=/A_DRIVE", env=environment)
    assert listener.wait() == 0
    assert [line for line in listener.lines if "DRIVE" in line] == [
        f"/A_DRIVE {number / 2:g}" for number in range(20)
    ]


def test_a_log_of_a_c_program_is_read(drive, tmp_path, cli):
    path = str(tmp_path / "c.lcmlog")
    subprocess.run([drive, "write", path, "20"], check=True)
    with Log(path) as log:
        assert log.duration == 1.9
        values = [arrival.message for arrival in log.messages("C_DRIVE")]
    assert all(isinstance(value, Twist) for value in values)
    assert [value.linear.x for value in values] == [number / 2 for number in range(20)]
    assert "nothing is damaged" in cli("bag", "fix", path, f"{path}.fixed").err
    assert Path(f"{path}.fixed").read_bytes() == Path(path).read_bytes()


def test_a_c_program_reads_what_lcmtools_writes(drive, tmp_path, cli):
    path, cut = str(tmp_path / "c.lcmlog"), str(tmp_path / "cut.lcmlog")
    subprocess.run([drive, "write", path, "20"], check=True)
    assert_line(cli("bag", "cut", path, cut, "-s", "1s").err, "lcmtools bag cut: ", "latched")
    found = subprocess.run([drive, "read", cut, "0"], check=True, capture_output=True, text=True)
    assert found.stdout.splitlines() == [
        f"{number} C_DRIVE 56 {(number + 10) / 2:g}" for number in range(10)
    ]
