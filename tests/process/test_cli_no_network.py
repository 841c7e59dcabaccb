"""Where multicast does not work, everything says so at once; liblcm would freeze for 10 s."""

import subprocess

import pytest

REMEDY = "type: sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"
LINE = f"no multicast route to 239.255.76.67:7667; {REMEDY}"

pytestmark = pytest.mark.usefixtures("bare_network")


@pytest.mark.parametrize(
    "command",
    [
        *("list", "info a", "echo a", "type a", "hz a", "pub a std_msgs/String x", "topic list"),
        *("node list", "node info a", "node ping a", "node cleanup"),
        *(f"run {node}" for node in ("talker", "listener", "moving_robot", "simple_controller")),
        *("run evaluate_controller", "run sim"),
    ],
)
def test_command_says_what_to_type(command, cli):
    name = command.removesuffix(" a").removesuffix(" a std_msgs/String x")
    result = cli(*command.split())
    assert (result.code, result.out, result.err) == (1, "", f"lcmtools {name}: {LINE}\n")


@pytest.mark.parametrize("command", ["list", "run talker"])
def test_that_takes_under_a_second(command, start, lcmtools_path, stopwatch):
    process = start(lcmtools_path, *command.split())
    assert stopwatch(process.pid).until_end() < 1.0
    assert process.wait() == 1


def test_wtf_finds_the_missing_route(cli):
    result = cli("wtf")
    assert (result.code, result.err) == (2, "")
    assert result.out.splitlines()[:4] == [
        "Found 1 error(s).",
        "Something is wrong, and will not work as it is",
        "",
        "ERROR The bus does not work: no multicast route to 239.255.76.67:7667",
    ]
    assert f"   -> {REMEDY}\n" in result.out  # besides what there is to say of a container


def test_what_needs_no_bus_works(cli):
    for command in (
        "--help",
        "msg list",
        "msg show Twist --json",
        "run --list",
        "run talker --help",
    ):
        result = cli(*command.split())
        assert (result.code, result.err) == (0, "")


def test_remedy_is_one_that_works(cli):
    for command in REMEDY.removeprefix("type: ").replace("sudo ", "").split(" && "):
        subprocess.run(command.split(), check=True)
    assert cli("list").code == 0
