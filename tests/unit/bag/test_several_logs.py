"""Several logs as one, and parts of logs, in every command that looks and in Python."""

import json

import pytest
from fixtures.says import assert_says

import lcmtools.bag
from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.errors import UsageError
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.log_index import LostMessages, RecordedNode
from lcmtools.wire.packet import Packet, Sender

_S = 10**9
_START = 1_795_384_180 * _S
_COMMANDS = (
    *("echo /speed --json", "echo --all --csv", "echo '/sp*' --last 3", "hz /speed -n 1"),
    *("bw /speed", "list", "list --hz", "list -v", "info /speed", "type /speed", "find Float64"),
    *("node list", "node info /driver", "graph --format dot", "wtf", "spy --once"),
)


def _write(path, seconds):
    with LogWriter(path) as log:
        driver = log.sender_number(Sender("127.0.0.1", 4001), "/driver")
        ends = (Endpoint("/speed", Role.PUBLISHER, ("std_msgs/Float64",)),)
        node = NodeInfo("/driver", "id", "ada", 1, endpoints=ends)
        log.add_node(RecordedNode(_START, driver, encode_announcement(Announcement(node))))
        for second in seconds:
            time = _START + second * _S
            log.add(Packet("/speed", encode(Float64(data=float(second))), time), driver)
            if second % 4 == 0:
                log.add(Packet("RARE", encode(Float64(data=-float(second))), time), driver)
        lost = int(seconds.start == 0)
        log.add_lost(
            LostMessages(_START + seconds.start * _S, {driver: (lost, len(seconds) + lost)})
        )


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Runs a command; there are the logs whole, and its parts 0 and 1."""
    monkeypatch.chdir(tmp_path)
    _write("whole", range(20))
    _write("0", range(10))
    _write("1", range(10, 20))

    def run(command, *more):
        code = main([*(word.strip("'") for word in command.split()), *more])
        return code, capsys.readouterr().out

    return run


@pytest.mark.parametrize(
    ("command", "order"), [(_COMMANDS[0], "01"), *((command, "10") for command in _COMMANDS)]
)
def test_a_split_recording_is_read_as_one_log(run, command, order):
    code, out = run(command, "-b", "whole")
    got, found = run(command, *(word for name in order for word in ("-b", name)))
    assert out
    assert (got, found) == (code, out)


@pytest.mark.parametrize(
    ("part", "numbers"),
    [
        ("-s 17s -b 1 -b 0", [17, 18, 19]),
        ("-s end-2s -b whole", [17, 18, 19]),
        ("--start 2s --end 4s -b whole", [2, 3, 4]),
        ("-e end-17s -b 1 -b 0", [0, 1, 2]),
        ("--last 2 -b 1 -b 0", [18, 19]),
        ("--last 2 -e 5s -b whole", [4, 5]),
        ("-s 1795384198 -b 1 -b 0", [18, 19]),
    ],
)
def test_a_part_of_a_log(run, part, numbers):
    code, out = run(f"echo /speed --json {part}")
    found = [json.loads(line)["data"] for line in out.splitlines()]
    assert (code, found) == (0, numbers)


@pytest.mark.parametrize(
    "command",
    [
        "hz /speed",
        "bw /speed",
        "list --hz",
        "info /speed",
        "wtf",
        "spy --once",
        "node list",
        "type /speed",
    ],
)
def test_every_looking_command_takes_a_part(run, command):
    start, end = ("--start", "--end") if command.startswith("list") else ("-s", "-e")
    assert run(f"bag cut whole part {start} 4s {end} 8s")[0] == 0
    said, out = run(command, "-b", "part")
    assert run(command, "-b", "whole", start, "4s", end, "8s") == (said, out)


def test_of_each_topic_the_last_ones(run):
    _, out = run("echo --all --csv --last 1 -b whole")
    assert [line.split(",")[-1] for line in out.splitlines()[1:]] == ["-16.0", "19.0"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("echo /speed -s 1s", "--start is for logs; name one with -b"),
        ("hz /speed --last 3", "--last is for logs; name one with -b"),
        ("echo /speed -b whole -s 99s", "the start, 99s, is after the end of the log"),
        ("echo /speed -b whole -s soon", "'soon' is not a time"),
    ],
)
@pytest.mark.usefixtures("run")
def test_wrong_parts(words, says, capsys):
    assert main(words.split()) == 2
    assert_says(capsys.readouterr().err, says)


@pytest.mark.parametrize(
    ("start", "end", "numbers"),
    [
        (_START + 17 * _S, None, [17, 18, 19]),
        (17, None, [17, 18, 19]),
        (17.0, 18.5, [17, 18]),
        (-2, None, [17, 18, 19]),
        ("end-2s", "end", [17, 18, 19]),
        (float(_START // _S + 18), None, [18, 19]),
    ],
)
@pytest.mark.usefixtures("run")
def test_python_takes_a_logs_own_times(start, end, numbers):
    with lcmtools.bag.open("whole") as log:
        assert [one.message.data for one in log.messages("/speed", start=start, end=end)] == numbers
        assert len([*log.messages("/speed", start=log.start, end=log.end)]) == 20
        assert len([*log.messages("/speed", start=next(iter(log)).time)]) == 20
        for wrong in (float("nan"), True):
            with pytest.raises(UsageError, match="is not a time"):
                log.messages("/speed", start=wrong)


@pytest.mark.usefixtures("run")
def test_python_takes_lists_and_patterns_of_topics():
    with lcmtools.bag.open("whole") as log:
        assert len([*log.messages(["/speed", "RARE"])]) == 25
        assert len([*log.messages("/sp*", ["RARE"])]) == 25
        assert len([*log.messages(("RAR?",))]) == 5
    assert len([*lcmtools.observe.messages("/speed", log=["1", "0"])]) == 20
