"""msg and srv: what they say of the types, and that pub takes what msg proto prints."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
Run = Callable[..., subprocess.CompletedProcess[str]]

TWIST = "linear:\n  x: 0.0\n  y: 0.0\n  z: 0.0\nangular:\n  x: 0.0\n  y: 0.0\n  z: 0.0\n"


def test_msg_package_lists_the_types_of_a_package(lcmtools: Run) -> None:
    result = lcmtools("msg", "package", "tf2_msgs")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == "tf2_msgs/TF2Error\ntf2_msgs/TFMessage\n"
    assert json.loads(lcmtools("msg", "package", "tf2_msgs", "--json").stdout) == [
        "tf2_msgs/TF2Error",
        "tf2_msgs/TFMessage",
    ]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("geometry_msg", "did you mean geometry_msgs?"), ("zzz", "see: lcmtools msg packages")],
)
def test_msg_package_of_an_unknown_package_is_exit_code_2(
    name: str, hint: str, lcmtools: Run
) -> None:
    result = lcmtools("msg", "package", name)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == f"lcmtools msg package: unknown package '{name}'; {hint}\n"


def test_msg_packages_lists_each_package_once(lcmtools: Run) -> None:
    rows = lcmtools("msg", "packages").stdout.splitlines()
    assert rows == sorted(set(rows))
    assert {"geometry_msgs", "std_msgs", "sensor_msgs"} <= set(rows)
    assert json.loads(lcmtools("msg", "packages", "--json").stdout) == rows


@pytest.mark.parametrize("verb", ["fingerprint", "md5"])
@pytest.mark.parametrize("name", ["geometry_msgs/Vector3", "geometry_msgs.Vector3"])
def test_msg_fingerprint_prints_sixteen_digits(verb: str, name: str, lcmtools: Run) -> None:
    result = lcmtools("msg", verb, name)
    assert (result.returncode, result.stdout, result.stderr) == (0, "ae7e5fba5eeca11e\n", "")


def test_msg_fingerprint_of_a_short_name_names_every_type_called_so(lcmtools: Run) -> None:
    assert lcmtools("msg", "fingerprint", "Vector3").stdout == (
        "[geometry_msgs/Vector3]: ae7e5fba5eeca11e\n"
    )
    rows = lcmtools("msg", "fingerprint", "Time").stdout.splitlines()
    assert [row.partition(":")[0] for row in rows] == [
        "[builtin_interfaces/Time]",
        "[std_msgs/Time]",
    ]
    assert json.loads(lcmtools("msg", "md5", "Vector3", "--json").stdout) == [
        {"type": "geometry_msgs/Vector3", "fingerprint": "ae7e5fba5eeca11e"}
    ]


@pytest.mark.parametrize("verb", ["fingerprint", "proto"])
def test_unknown_type_is_exit_code_2_with_a_near_miss(verb: str, lcmtools: Run) -> None:
    result = lcmtools("msg", verb, "Twits")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == (
        f"lcmtools msg {verb}: unknown type 'Twits'; did you mean geometry_msgs/Twist?\n"
    )


def test_msg_find_field_prints_types_with_the_field(lcmtools: Run) -> None:
    result = lcmtools("msg", "find-field", "angular")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == (
        "geometry_msgs/Accel: geometry_msgs/Vector3 angular\n"
        "geometry_msgs/Twist: geometry_msgs/Vector3 angular\n"
    )
    assert json.loads(lcmtools("msg", "find-field", "--json", "angular").stdout)[0] == {
        "type": "geometry_msgs/Accel",
        "field": "geometry_msgs/Vector3 angular",
    }


def test_msg_find_field_that_no_type_has_is_exit_code_1_with_a_near_miss(lcmtools: Run) -> None:
    result = lcmtools("msg", "find-field", "angluar")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (
        "lcmtools msg find-field: no message type has a field 'angluar'; did you mean angular?\n"
    )


def test_msg_proto_prints_yaml_that_pub_takes_unchanged(
    lcmtools: Run,
    start: Callable[..., Any],
    lcmtools_path: str,
    bus_url: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    prototype = lcmtools("msg", "proto", "Twist")
    assert (prototype.returncode, prototype.stdout, prototype.stderr) == (0, TWIST, "")
    start(lcmtools_path, "pub", "-r", "20", "/cmd_vel", "Twist", prototype.stdout)
    echo = lcmtools("echo", "-1", "/cmd_vel").stdout
    assert echo.replace(": \n", ":\n") == f"{TWIST}---\n"


def test_msg_proto_json_is_one_line(lcmtools: Run) -> None:
    result = lcmtools("msg", "proto", "--json", "std_msgs/String")
    assert result.stdout.count("\n") == 1
    assert json.loads(result.stdout) == {"data": ""}


def test_srv_list_prints_the_service_types(lcmtools: Run) -> None:
    result = lcmtools("srv", "list")
    listed = result.stdout.splitlines()
    assert (result.returncode, result.stderr) == (0, "")
    assert {"std_srvs/Empty", "std_srvs/SetBool", "std_srvs/Trigger", "sim_msgs/Step"} <= set(
        listed
    )
    assert listed == sorted(listed)
    assert json.loads(lcmtools("srv", "list", "--json").stdout) == listed


def test_srv_show_prints_request_and_response(lcmtools: Run) -> None:
    text = "bool data\n---\nbool success\nstring message\n"
    assert lcmtools("srv", "show", "std_srvs/srv/SetBool").stdout == text
    assert lcmtools("srv", "show", "SetBool").stdout == f"[std_srvs/SetBool]:\n{text}"
    assert lcmtools("srv", "show", "std_srvs/Empty").stdout == "---\n"
    assert json.loads(lcmtools("srv", "show", "SetBool", "--json").stdout) == {
        "type": "std_srvs/SetBool",
        "request": "bool data",
        "response": "bool success\nstring message",
    }


def test_srv_show_of_an_unknown_type_is_exit_code_2_with_a_near_miss(lcmtools: Run) -> None:
    result = lcmtools("srv", "show", "std_srvs/Triger")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == (
        "lcmtools srv show: unknown service type 'std_srvs/Triger'; "
        "did you mean std_srvs/Trigger?\n"
    )


def test_msg_show_r_prints_the_file_with_its_comments(lcmtools: Run) -> None:
    file = ROOT / "lcm_types" / "sensor_msgs" / "LaserScan.lcm"
    result = lcmtools("msg", "show", "-r", "LaserScan")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == f"[sensor_msgs/LaserScan]:\n{file.read_text().strip()}\n"
    assert "// [rad] from one beam to the next" in result.stdout


def test_srv_show_r_prints_both_files(lcmtools: Run) -> None:
    folder = ROOT / "lcm_types" / "std_srvs"
    request, response = (
        (folder / f"SetBool_{part}.lcm").read_text().strip() for part in ("Request", "Response")
    )
    result = lcmtools("srv", "show", "-r", "std_srvs/SetBool")
    assert result.stdout == f"{request}\n---\n{response}\n"
