"""Where multicast does not work, everything says so at once; liblcm would freeze for 10 s."""

import subprocess

import pytest

REMEDY = "type: sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"
LINE = f"no multicast route to 239.255.76.67:7667; {REMEDY}"

pytestmark = pytest.mark.usefixtures("bare_network")


@pytest.fixture
def timed(lcmtools_path, stopwatch):
    """``timed("list")``: the seconds that it takes, its exit code and what it writes.

    Of three attempts the fastest: a computer may be slow for other reasons than no processor.
    """

    def run_once(arguments):
        pipe = subprocess.PIPE
        process = subprocess.Popen(
            [lcmtools_path, *arguments], stdin=pipe, stdout=pipe, stderr=pipe, text=True
        )
        seconds = stopwatch(process.pid).until_end()
        out, error = process.communicate()
        return seconds, (process.returncode, out, error)

    def run(*arguments):
        best = run_once(arguments)
        for _ in range(2):
            if best[0] >= 1.0:
                best = min(best, run_once(arguments))
        return best

    return run


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
def test_command_says_what_to_type_in_under_a_second(command, timed):
    seconds, result = timed(*command.split())
    name = command.removesuffix(" a").removesuffix(" a std_msgs/String x")
    assert result == (1, "", f"lcmtools {name}: {LINE}\n")
    assert seconds < 1.0


@pytest.mark.parametrize(
    "node",
    ["talker", "listener", "moving_robot", "simple_controller", "evaluate_controller", "sim"],
)
def test_node_says_what_to_type_in_under_a_second(node, timed):
    seconds, result = timed("run", node)
    assert result == (1, "", f"lcmtools run {node}: {LINE}\n")
    assert seconds < 1.0


def test_wtf_finds_the_missing_route_in_under_a_second(timed):
    seconds, (code, out, error) = timed("wtf")
    assert (code, error) == (2, "")
    assert out.splitlines()[:4] == [
        "Found 1 error(s).",
        "Something is wrong, and will not work as it is",
        "",
        "ERROR The bus does not work: no multicast route to 239.255.76.67:7667",
    ]
    assert f"   -> {REMEDY}\n" in out  # besides what there is to say of a container
    assert seconds < 1.0


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
