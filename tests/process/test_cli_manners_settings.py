"""Settings by flag, environment and file, for commands and for nodes; and colour on a terminal."""

import json
import re

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.settings import VARIABLES

_YELLOW = "\x1b[33m"


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Writes the user's file."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))

    def do(text):
        path = tmp_path / "lcmtools" / "config.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    return do


def test_file_moves_commands_and_nodes_to_its_bus(
    write, start, cli, lcmtools_path, bus_url, wait_until
):
    write(f"lcm_url: {bus_url}\nnamespace: /husky0\n")
    start(lcmtools_path, "run", "talker").wait_for("[/husky0/talker]: hello world")
    names = cli("node", "list", "--lcm-url", bus_url, env={"XDG_CONFIG_HOME": "/nowhere"}).out
    assert names == "/husky0/talker\n"
    wait_until(lambda: cli("node", "list").out == "/husky0/talker\n")
    echo = cli("echo", "-1", "chatter", "--timeout", "5s")
    assert echo.out.startswith("data: ")


def test_config_is_a_table_for_people(write, cli):
    path = write("domain: 3\n")
    result = cli("config", env={"LCMTOOLS_NAMESPACE": "/husky0"})
    rows = [line.split() for line in result.out.splitlines()]
    assert ["domain", "3", f"{path}:1"] in rows
    assert ["namespace", "/husky0", "LCMTOOLS_NAMESPACE"] in rows
    assert ["timeout", "-", "default"] in rows
    assert ["bus", "udpm://239.255.76.67:7670?ttl=0", f"{path}:1"] in rows
    assert rows[-1] == ["file:", str(path)]
    path.unlink()
    assert cli("config").out.endswith(f"file: {path} (there is none)\n")


def test_config_shows_every_variable_and_the_workspaces(write, cli, tmp_path):
    write("")
    given = {"LCMTOOLS_TYPE_PATH": "/types", "LCMTOOLS_PACKAGE_PATH": f"{tmp_path}:/lost"}
    rows = [line.split() for line in cli("config", env=given).out.splitlines()]
    assert ["workspaces", str(tmp_path), "LCMTOOLS_PACKAGE_PATH"] in rows
    shown = {row[0]: row[1] for row in rows}
    assert shown["LCMTOOLS_TYPE_PATH"] == "/types"
    assert shown["LCMTOOLS_ENGINE"] == "-"
    assert "GAZEBO_MODEL_PATH" not in shown
    rows = [
        line.split() for line in cli("config", env={"GAZEBO_MODEL_PATH": "/m"}).out.splitlines()
    ]
    assert ["workspaces", "-", f"{tmp_path}/lcmtools/workspaces"] in rows
    assert ["GAZEBO_MODEL_PATH", "/m"] in [row[:2] for row in rows]
    record = json.loads(cli("config", "--json", env=given).out)
    assert [one["name"] for one in record["variables"]] == list(VARIABLES)
    assert record["workspaces"] == {"value": [str(tmp_path)], "source": "LCMTOOLS_PACKAGE_PATH"}


def test_timeout_of_file_and_environment_counts(write, cli, bus_url):
    write("timeout: 300ms\n")
    nothing = cli("echo", "/nothing", env={"LCM_DEFAULT_URL": bus_url})
    assert nothing.code == 4
    assert_says(nothing.err, "/nothing", "0.3 s")
    environment = {"LCM_DEFAULT_URL": bus_url, "LCMTOOLS_TIMEOUT": "0.2"}
    assert "within 0.2 s" in cli("echo", "/nothing", env=environment).err
    told = cli("echo", "/nothing", "--timeout", "100ms", env=environment).err
    assert "within 0.1 s" in told


@pytest.mark.parametrize(
    "command", ["list", "wtf", "config", "run talker", "pub /a std_msgs/Empty"]
)
def test_broken_file_costs_one_line_that_names_it(command, write, cli, bus_url):
    path = write("domain: 3\ncolour: never\n")
    result = cli(*command.split(), env={"LCM_DEFAULT_URL": bus_url})
    name = "pub" if command.startswith("pub") else command
    assert (result.code, result.out) == (2, "")
    parts = (f"{path}:2: ", "no setting 'colour'", "did you mean color?")
    assert_line(result.err, f"lcmtools {name}: ", *parts)


@pytest.mark.parametrize("command", ["--help", "--version", "help list", "list -h", "msg list"])
def test_broken_file_stops_nothing_that_does_without(command, write, cli):
    write("domain: [\n")
    result = cli(*command.split())
    assert (result.code, result.err) == (0, "")


def test_home_that_cannot_be_read_is_named_and_gone_on_with(cli, bus_url, tmp_path):
    """As with ``sudo -E`` and a home that root may not read."""
    loop = tmp_path / "home"
    loop.symlink_to(loop)
    environment = {"LCM_DEFAULT_URL": bus_url, "XDG_CONFIG_HOME": str(loop)}
    result = cli("pub", "-1", "/chatter", "std_msgs/String", "data: a", env=environment)
    assert result.code == 0
    assert f"lcmtools: cannot look into {loop}/lcmtools: " in result.err
    assert cli("config", env=environment).code == 0


def test_complaint_on_a_terminal_has_its_command_in_colour(on_terminal):
    assert on_terminal("list", "--wait", "x").startswith("\x1b[1;31mlcmtools list:\x1b[0m invalid")


@pytest.mark.parametrize(
    ("words", "environment"),
    [
        ("msg show Nope", {"TERM": "dumb"}),
        ("--color=never msg show Nope", {"FORCE_COLOR": "1"}),
        ("msg show --no-color Nope", {}),
    ],
)
def test_terminal_without_colour_gets_no_escape(words, environment, on_terminal):
    text = on_terminal(*words.split(), **environment)
    assert_says(text, "lcmtools msg show: ", "type 'Nope'")
    assert "\x1b" not in text


@pytest.mark.parametrize(
    ("arguments", "environment"),
    [
        (["--color", "always"], {}),
        (["--color=always"], {"NO_COLOR": "1"}),
        ([], {"FORCE_COLOR": "1"}),
        ([], {"CLICOLOR_FORCE": "1"}),
        ([], {"LCMTOOLS_COLOR": "always"}),
    ],
)
def test_pipe_gets_colour_on_demand_only(arguments, environment, cli):
    words = ["msg", "show", "Nope"]
    assert "\x1b" not in cli(*words).err
    assert cli(*words, *arguments, env=environment).err.startswith("\x1b[1;31m")


@pytest.mark.usefixtures("private_network")  # programs on other buses would be named
def test_wtf_colours_the_severity_and_nothing_else(
    on_terminal, cli, start, lcmtools_path, bus_url, wait_until
):
    start(lcmtools_path, "run", "listener", LCM_DEFAULT_URL=bus_url)
    wait_until(lambda: cli("node", "list", env={"LCM_DEFAULT_URL": bus_url}).out == "/listener\n")
    wtf = ("wtf", "--wait", "100ms", "--ignore", "other-buses")  # where other tests run meanwhile
    screen = on_terminal(*wtf, LCM_DEFAULT_URL=bus_url).replace("\r\n", "\n")
    assert f"{_YELLOW}WARNING\x1b[0m The following node subscriptions are unconnected:" in screen
    piped = cli(*wtf, env={"LCM_DEFAULT_URL": bus_url}).out
    assert "\x1b" not in piped
    findings = re.findall(r"^(?:ERROR|WARNING|NOTE) ", piped, re.MULTILINE)
    assert screen.count("\x1b[0m") == screen.count("\x1b[") / 2 == len(findings)


def test_warning_of_a_node_is_yellow_on_a_terminal_and_plain_in_a_pipe(
    start, lcmtools_path, bus_url
):
    words = (lcmtools_path, "run", "talker", "--domain", "3", "--lcm-url", bus_url)
    plain = start(*words)
    assert plain.wait_for("has no effect").startswith("[WARN] [")
    colored = start(*words, FORCE_COLOR="1")
    assert colored.wait_for("has no effect").startswith(f"{_YELLOW}[WARN] [")
    by_flag = start(lcmtools_path, "--color=always", *words[1:])
    assert by_flag.wait_for("has no effect").startswith(f"{_YELLOW}[WARN] [")
