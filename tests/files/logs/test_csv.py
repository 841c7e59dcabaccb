"""CSV of logs: its columns are those of all messages, whichever comes first."""

from pathlib import Path

import pytest
from fixtures.wire import encode_event

from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Float64, String
from lcmtools.types.trajectory_msgs import JointTrajectoryPoint
from lcmtools.wire.packet import Packet


def point(positions, effort):
    message = JointTrajectoryPoint()
    message.positions, message.effort = positions, effort
    return message


def text(data):
    return String(data=data)


def exported(cli, tmp_path, messages, code=0):
    path, out = tmp_path / "a.lcmlog", tmp_path / "out.csv"
    events = (
        encode_event(n, Packet("/a", encode(one), n * 1000)) for n, one in enumerate(messages)
    )
    path.write_bytes(b"".join(events))
    result = cli("bag", "export", str(path), str(out))
    assert result.code == code, result
    return out.read_text(encoding="utf-8").splitlines()


TAIL = "field.time_from_start"


@pytest.mark.parametrize(
    ("points", "columns", "rows"),
    [
        ([([], []), ([1], [2])], ["positions0", "effort0"], [",", "1.0,2.0"]),
        ([([1], []), ([1, 2], [])], ["positions0", "positions1"], ["1.0,", "1.0,2.0"]),
        (
            [([1, 2], [3]), ([4], [5, 6])],
            ["positions0", "positions1", "effort0", "effort1"],
            ["1.0,2.0,3.0,", "4.0,,5.0,6.0"],
        ),
        ([([1], [2]), ([], [])], ["positions0", "effort0"], ["1.0,2.0", ","]),
    ],
)
def test_columns_are_those_of_the_longest_arrays(points, columns, rows, cli, tmp_path):
    head, *found = exported(cli, tmp_path, [point(*one) for one in points])
    names = head.split(",")
    assert [name for name in names if not name.startswith(TAIL)] == [
        "%time",
        *(f"field.{column}" for column in columns),
    ]
    assert [",".join(row.split(",")[1 : len(columns) + 1]) for row in found] == rows


def test_echo_has_the_same_columns(cli, tmp_path):
    messages = [point([1], []), point([1, 2], [3]), point([], [4, 5])]
    rows = exported(cli, tmp_path, messages)
    path = str(tmp_path / "a.lcmlog")
    assert cli("echo", "-b", path, "/a", "--csv").ok().splitlines() == rows
    content = Path(path).read_bytes()
    assert cli("echo", "-b", "-", "/a", "--csv", input=content).ok().splitlines() == rows
    first = cli("echo", "-b", path, "/a", "--csv", "-n", "2").ok().splitlines()
    assert first[0] == rows[0].replace(",field.effort1", "")
    assert [row.split(",")[1] for row in first[1:]] == ["1.0", "1.0"]


def test_text_survives(cli, tmp_path):
    words = ['a, "b"', "line\r\nend", "é", ""]
    rows = exported(cli, tmp_path, [text(word) for word in words])
    assert rows == ["%time,field.data", '0,"a, ""b"""', '1000,"line', 'end"', "2000,é", "3000,"]


def test_another_type_is_left_out_by_name(cli, tmp_path):
    messages = [text("a"), Float64(), text("b")]
    assert exported(cli, tmp_path, messages, code=1) == ["%time,field.data", "0,a", "2000,b"]
