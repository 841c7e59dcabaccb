"""msg and srv: what they say of the types, and that pub takes what msg proto prints."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

TWIST = "linear:\n  x: 0.0\n  y: 0.0\n  z: 0.0\nangular:\n  x: 0.0\n  y: 0.0\n  z: 0.0\n"


def test_msg_package_lists_the_types_of_a_package(cli):
    result = cli("msg", "package", "tf2_msgs")
    assert (result.code, result.err) == (0, "")
    assert result.out == "tf2_msgs/TF2Error\ntf2_msgs/TFMessage\n"
    assert json.loads(cli("msg", "package", "tf2_msgs", "--json").out) == [
        "tf2_msgs/TF2Error",
        "tf2_msgs/TFMessage",
    ]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("geometry_msg", "did you mean geometry_msgs?"), ("zzz", "see: lcmtools msg packages")],
)
def test_msg_package_of_an_unknown_package_is_exit_code_2(name, hint, cli):
    result = cli("msg", "package", name)
    assert (result.code, result.out) == (2, "")
    assert result.err == f"lcmtools msg package: unknown package '{name}'; {hint}\n"


def test_msg_packages_lists_each_package_once(cli):
    rows = cli("msg", "packages").out.splitlines()
    assert rows == sorted(set(rows))
    assert {"geometry_msgs", "std_msgs", "sensor_msgs"} <= set(rows)
    assert json.loads(cli("msg", "packages", "--json").out) == rows


@pytest.mark.parametrize("verb", ["fingerprint", "md5"])
@pytest.mark.parametrize("name", ["geometry_msgs/Vector3", "geometry_msgs.Vector3"])
def test_msg_fingerprint_prints_sixteen_digits(verb, name, cli):
    result = cli("msg", verb, name)
    assert (result.code, result.out, result.err) == (0, "ae7e5fba5eeca11e\n", "")


def test_msg_fingerprint_of_a_short_name_names_every_type_called_so(cli):
    assert cli("msg", "fingerprint", "Vector3").out == (
        "[geometry_msgs/Vector3]: ae7e5fba5eeca11e\n"
    )
    rows = cli("msg", "fingerprint", "Time").out.splitlines()
    assert [row.partition(":")[0] for row in rows] == [
        "[builtin_interfaces/Time]",
        "[std_msgs/Time]",
    ]
    assert json.loads(cli("msg", "md5", "Vector3", "--json").out) == [
        {"type": "geometry_msgs/Vector3", "fingerprint": "ae7e5fba5eeca11e"}
    ]


@pytest.mark.parametrize("verb", ["fingerprint", "proto"])
def test_unknown_type_is_exit_code_2_with_a_near_miss(verb, cli):
    result = cli("msg", verb, "Twits")
    assert (result.code, result.out) == (2, "")
    assert result.err == (
        f"lcmtools msg {verb}: unknown type 'Twits'; did you mean geometry_msgs/Twist?\n"
    )


def test_msg_find_field_prints_types_with_the_field(cli):
    result = cli("msg", "find-field", "angular")
    assert (result.code, result.err) == (0, "")
    assert result.out == (
        "geometry_msgs/Accel: geometry_msgs/Vector3 angular\n"
        "geometry_msgs/Twist: geometry_msgs/Vector3 angular\n"
    )
    assert json.loads(cli("msg", "find-field", "--json", "angular").out)[0] == {
        "type": "geometry_msgs/Accel",
        "field": "geometry_msgs/Vector3 angular",
    }


def test_msg_find_field_that_no_type_has_is_exit_code_1_with_a_near_miss(cli):
    result = cli("msg", "find-field", "angluar")
    assert (result.code, result.out) == (1, "")
    assert result.err == (
        "lcmtools msg find-field: no message type has a field 'angluar'; did you mean angular?\n"
    )


def test_msg_proto_prints_yaml_that_pub_takes_unchanged(
    cli, start, lcmtools_path, bus_url, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    prototype = cli("msg", "proto", "Twist")
    assert (prototype.code, prototype.out, prototype.err) == (0, TWIST, "")
    start(lcmtools_path, "pub", "-r", "20", "/cmd_vel", "Twist", prototype.out)
    echo = cli("echo", "-1", "/cmd_vel").out
    assert echo.replace(": \n", ":\n") == f"{TWIST}---\n"


def test_msg_proto_json_is_one_line(cli):
    result = cli("msg", "proto", "--json", "std_msgs/String")
    assert result.out.count("\n") == 1
    assert json.loads(result.out) == {"data": ""}


def test_srv_list_prints_the_service_types(cli):
    result = cli("srv", "list")
    listed = result.out.splitlines()
    assert (result.code, result.err) == (0, "")
    assert {"std_srvs/Empty", "std_srvs/SetBool", "std_srvs/Trigger", "sim_msgs/Step"} <= set(
        listed
    )
    assert listed == sorted(listed)
    assert json.loads(cli("srv", "list", "--json").out) == listed


def test_srv_show_prints_request_and_response(cli):
    text = "bool data\n---\nbool success\nstring message\n"
    assert cli("srv", "show", "std_srvs/srv/SetBool").out == text
    assert cli("interface", "show", "std_srvs/srv/SetBool").out == text  # as in ROS 2
    assert cli("srv", "show", "SetBool").out == f"[std_srvs/SetBool]:\n{text}"
    assert cli("srv", "show", "std_srvs/Empty").out == "---\n"
    assert json.loads(cli("srv", "show", "SetBool", "--json").out) == {
        "type": "std_srvs/SetBool",
        "request": "bool data",
        "response": "bool success\nstring message",
    }


def test_srv_show_of_an_unknown_type_is_exit_code_2_with_a_near_miss(cli):
    result = cli("srv", "show", "std_srvs/Triger")
    assert (result.code, result.out) == (2, "")
    assert result.err == (
        "lcmtools srv show: unknown service type 'std_srvs/Triger'; "
        "did you mean std_srvs/Trigger?\n"
    )


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
