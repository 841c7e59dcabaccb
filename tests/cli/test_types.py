"""msg and srv, beside their transcript: lists, files, and that pub takes what msg proto prints."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

TWIST = "linear:\n  x: 0.0\n  y: 0.0\n  z: 0.0\nangular:\n  x: 0.0\n  y: 0.0\n  z: 0.0\n"


@pytest.mark.parametrize(
    ("command", "some"),
    [
        ("msg list", {"geometry_msgs/Twist", "std_msgs/String", "nav_msgs/Odometry"}),
        ("msg packages", {"geometry_msgs", "std_msgs"}),
        ("srv list", {"std_srvs/Empty", "std_srvs/SetBool", "sim_msgs/Step"}),
    ],
)
def test_names_are_listed_once_and_sorted(command, some, cli):
    names = cli(*command.split()).ok().splitlines()
    assert names == sorted(set(names))
    assert some <= set(names)
    assert json.loads(cli(*command.split(), "--json").out) == names


def test_msg_proto_prints_yaml_that_pub_takes_unchanged(
    cli, start, lcmtools_path, bus_url, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    prototype = cli("msg", "proto", "Twist")
    assert (prototype.code, prototype.out, prototype.err) == (0, TWIST, "")
    start(lcmtools_path, "pub", "-r", "20", "/cmd_vel", "Twist", prototype.out)
    echo = cli("echo", "-1", "/cmd_vel").out
    assert echo.replace(": \n", ":\n") == f"{TWIST}---\n"


def test_msg_show_r_prints_the_file_with_its_comments(cli):
    file = ROOT / "lcm_types" / "sensor_msgs" / "LaserScan.lcm"
    result = cli("msg", "show", "-r", "LaserScan")
    said = result.err.removeprefix("types are spelt as in LCM; this is ").rstrip("\n")
    assert Path(said).expanduser().resolve().read_text() == file.read_text()
    assert result.out == f"[sensor_msgs/LaserScan]:\n{file.read_text().strip()}\n"
    assert "// [rad] from one beam to the next" in result.out


def test_srv_show_r_prints_both_files(cli):
    folder = ROOT / "lcm_types" / "std_srvs"
    request, response = (
        (folder / f"SetBool_{part}.lcm").read_text().strip() for part in ("Request", "Response")
    )
    result = cli("srv", "show", "-r", "std_srvs/SetBool")
    assert result.out == f"{request}\n---\n{response}\n"
