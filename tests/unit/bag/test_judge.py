"""Logs held against a contract, compared, and measured."""

import json
from pathlib import Path

import pytest
from fixtures.says import assert_says

from lcmtools.bag.writer import LogWriter
from lcmtools.cli.main import main
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.log_index import LostMessages
from lcmtools.wire.packet import Packet, Sender

_SECOND = 1_000_000_000
Captured = pytest.CaptureFixture[str]


def _write(path, numbers, late=0):
    with LogWriter(path) as log:
        sender = log.sender_number(Sender("127.0.0.1", 1), "/driver")
        message = Float64()
        for number in numbers:
            message.data = float(number)
            log.add(Packet("/speed", encode(message), number * _SECOND // 10 + late), sender)
            if number % 10 == 0:
                log.add(Packet("/raw", b"12345678" * 10, number * _SECOND // 10 + late), sender)
        log.add_lost(LostMessages(0, {sender: (2, 1000)}))


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _write("a.lcmlog", [*range(50), *range(60, 100)])


def _check(contract, capsys):
    Path("c.yaml").write_text(contract)
    code = main(["bag", "check", "a.lcmlog", "--against", "c.yaml"])
    out, error = capsys.readouterr()
    return code, (out + error).splitlines()


def test_a_log_that_keeps_its_contract(capsys):
    contract = (
        "topics:\n  /speed:\n    type: std_msgs/Float64\n    min_rate: 8\n    max_rate: 10\n"
        "    max_gap: 1.2\n  /r*:\n  /none:\n    max_messages: 0\n"
        "others: false\nmax_lost: 2\nmin_duration: 9\n"
    )
    assert _check(contract, capsys) == (0, ["a.lcmlog meets c.yaml"])


@pytest.mark.parametrize(
    ("contract", "text"),
    [
        ("topics:\n  /speed:\n    min_rate: 20\n", "/speed: 8.99 Hz, at least 20.00 Hz required"),
        ("topics:\n  /speed:\n    max_rate: 5\n", "/speed: 8.99 Hz, at most 5.00 Hz required"),
        (
            "topics:\n  /speed:\n    max_gap: 1\n",
            "/speed: without a message for 1.1 s, at most 1 s required",
        ),
        (
            "topics:\n  /speed:\n    type: std_msgs/Int8\n",
            "/speed: the type is std_msgs/Float64, not std_msgs/Int8",
        ),
        ("topics:\n  /none:\n", "/none: there are no messages"),
    ],
)
def test_a_broken_term_is_named_with_its_line(contract, text, capsys):
    assert _check(contract, capsys) == (1, [f"FAIL {text} (c.yaml:2)"])


def test_terms_of_the_whole_log(capsys):
    contract = "topics:\n  /speed:\nothers: false\nmax_lost: 1\nmin_duration: 60\n"
    code, (lost, short, extra) = _check(contract, capsys)
    assert code == 1
    assert_says(lost, "FAIL 2 messages", "lost", "at most 1")
    assert_says(short, "FAIL", "9.9 s", "at least 60 s")
    assert_says(extra, "FAIL /raw: ", "contract")


@pytest.mark.parametrize(
    ("contract", "error"),
    [
        (
            "topics:\n  /a:\n    min_rat: 3\n",
            "c.yaml:3: unknown key 'min_rat' in '/a'; did you mean min_rate?",
        ),
        (
            "topics:\n  /a:\n    min_rate: fast\n",
            "c.yaml:3: 'min_rate' must be a number, not 'fast'",
        ),
        (
            "topics: 3\n",
            "c.yaml:1: 'topics' must be a mapping (key: value), not a single value",
        ),
        ("others: maybe\n", "c.yaml:1: 'others' must be true or false, not 'maybe'"),
        (
            "topics:\n  /a:\n    match: time\n",
            "c.yaml:3: 'match' must be stamp or order, not 'time'",
        ),
        (
            "topics:\n  /a:\n    fields: {x: 5 %}\n",
            (
                "c.yaml:3: '5 %' is no tolerance for x; "
                "write a number, a percentage such as 5%, angle or ignore"
            ),
        ),
    ],
)
def test_a_wrong_contract_is_refused(contract, error, capsys):
    code, rows = _check(contract, capsys)
    assert code == 2
    assert " ".join(rows) == f"lcmtools bag check: {' '.join(error.split())}"


def test_diff_compares_topic_by_topic(capsys):
    _write("b.lcmlog", [*range(50), *range(61, 101)])
    assert main(["bag", "diff", "a.lcmlog", "a.lcmlog"]) == 0
    assert capsys.readouterr().out == ""
    assert main(["bag", "diff", "a.lcmlog", "b.lcmlog"]) == 1
    raw, speed = capsys.readouterr().out.splitlines()
    assert_says(raw, "/raw: ", "1 only in the first", "1 only in the second", "8 in both")
    assert_says(speed, "/speed: ", "1 only in the first", "1 only in the second", "89 in both")
    _write("late.lcmlog", [*range(50), *range(60, 100)], late=_SECOND)
    assert main(["bag", "diff", "a.lcmlog", "late.lcmlog"]) == 1
    capsys.readouterr()
    assert main(["bag", "diff", "a.lcmlog", "late.lcmlog", "--ignore-times"]) == 0


def test_du_lists_the_largest_topic_first(capsys):
    assert main(["bag", "du", "a.lcmlog"]) == 0
    rows = [row.split() for row in capsys.readouterr().out.splitlines()]
    assert [row[-1] for row in rows] == ["/speed", "/raw"]
    assert main(["bag", "du", "a.lcmlog", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[1] == {"topic": "/raw", "bytes": 720}
