"""Where multicast does not work, everything says so at once; liblcm would freeze for 10 s."""

import subprocess
import time
from collections.abc import Callable

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]

REMEDY = "type: sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"
LINE = f"no multicast route to 239.255.76.67:7667; {REMEDY}"

pytestmark = pytest.mark.usefixtures("bare_network")


def timed(run: Callable[[], subprocess.CompletedProcess[str]]) -> tuple[float, object]:
    """The best time of up to eight, for this computer may be busy with something else."""
    best = 10.0
    for _ in range(8):
        begin = time.monotonic()
        result = run()
        best = min(best, time.monotonic() - begin)
        if best < 1.0:
            break
    return best, (result.returncode, result.stdout, result.stderr)


@pytest.mark.parametrize(
    "command",
    [
        "list",
        "info a",
        "echo a",
        "type a",
        "hz a",
        "pub a std_msgs/String x",
        "node list",
        "node info a",
        "node ping a",
        "node cleanup",
        "topic list",
    ],
)
def test_command_says_what_to_type_in_under_a_second(command: str, lcmtools: Run) -> None:
    seconds, result = timed(lambda: lcmtools(*command.split()))
    name = command.removesuffix(" a").removesuffix(" a std_msgs/String x")
    assert result == (1, "", f"lcmtools {name}: {LINE}\n")
    assert seconds < 1.0


@pytest.mark.parametrize(
    "node",
    ["talker", "listener", "moving_robot", "simple_controller", "evaluate_controller", "sim"],
)
def test_node_says_what_to_type_in_under_a_second(node: str, lcmtools: Run) -> None:
    seconds, result = timed(lambda: lcmtools("run", node))
    assert result == (1, "", f"lcmtools run {node}: {LINE}\n")
    assert seconds < 1.0


def test_wtf_finds_the_missing_route_in_under_a_second(lcmtools: Run) -> None:
    seconds, result = timed(lambda: lcmtools("wtf"))
    code, out, error = result
    assert (code, error) == (2, "")
    assert out.splitlines()[:4] == [
        "Found 1 error(s).",
        "Something is wrong, and will not work as it is",
        "",
        "ERROR The bus does not work: no multicast route to 239.255.76.67:7667",
    ]
    assert f"   -> {REMEDY}\n" in out  # besides what there is to say of a container
    assert seconds < 1.0


def test_what_needs_no_bus_works(lcmtools: Run) -> None:
    for command in ("--help", "msg list", "msg show Twist", "run --list", "run talker --help"):
        result = lcmtools(*command.split())
        assert (result.returncode, result.stderr) == (0, "")


def test_remedy_is_one_that_works(lcmtools: Run) -> None:
    for command in REMEDY.removeprefix("type: ").replace("sudo ", "").split(" && "):
        subprocess.run(command.split(), check=True)
    assert lcmtools("list").returncode == 0
