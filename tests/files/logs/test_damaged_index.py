"""Damage to the index beside a log costs names and speed; every message is still read."""

import json
from pathlib import Path

import pytest
from fixtures.strange_logs import MESSAGES, OWN, READERS, assert_readable, count_messages, write_log

from lcmtools.wire.log_index import SUFFIX

ODD = "own_msgs/Odd"
HASH = f"{OWN.fingerprint:#018x}"
BLOCK = [0, 100, 0, 1, {"/a": [1, 8, [[0, 1]], 0, 1, 0, None]}]


def line(key, *values):
    return json.dumps({key: [*values]})


def block(place, value):
    return line("block", *BLOCK[:place], value, *BLOCK[place + 1 :])


STRANGE = {
    "a type's file of another kind": line("type", ODD, HASH, "own_msgs/Own.msf", "float64 x"),
    "a type's file without a name": line("type", ODD, HASH, "", "float64 x"),
    "a type's file with NUL": line("type", ODD, HASH, "a\0b.msg", "float64 x"),
    "a type's file elsewhere": line("type", ODD, HASH, "/etc/Own.msg", "float64 x"),
    "a type's file above": line("type", ODD, HASH, "../../Own.msg", "float64 y"),
    "a surrogate in a type's text": line("type", ODD, HASH, "a/Own.msg", "float64 x # \ud800"),
    "a surrogate in a type's path": line("type", ODD, HASH, "a\ud800/Own.msg", "float64 x"),
    "a surrogate in a type's name": line("type", "own_msgs/\udfff", HASH, "a/B.msg", "float64 x"),
    "a type's name of another kind": line("type", ["own"], HASH, "a/B.msg", "float64 x"),
    "a fingerprint that is too large": line("type", ODD, "0x" + "f" * 40, "a/B.msg", "int8 x"),
    "a surrogate in a sender": line("sender", 0, ["10.0.0.\ud800", 1], "/a\ud800"),
    "JSON nested too deeply": '{"node": ' + "[" * 100_000,
    "infinite times": '{"node": [1e999, 0, ""]}',
    "an infinite size": '{"end": 1e999}',
    "infinite losses": '{"lost": [1e999, {"0": [1e999, 1]}]}',
    "a negative start": block(0, -100),
    "an end before the start": block(1, -1),
    "a time that no log has": block(2, 10**40),
    "a time that is text": block(3, "now"),
    "more bytes than there are": block(4, {"/a": [1, 10**9, [[0, 1]], 0, 1, 0, None]}),
    "more messages than there are": block(4, {"/a": [10**9, 8, [[0, 10**9]], 0, 1, 0, None]}),
    "no messages": block(4, {"/a": [0, 8, [[0, 0]], 0, 1, 0, None]}),
    "a fingerprint that is a list": block(4, {"/a": [1, 8, [[0, 1]], 0, 1, 0, [1]]}),
    "a gap that is a number with a point": block(4, {"/a": [1, 8, [[0, 1]], 0, 1, 0.5, 1]}),
    "a surrogate in a channel": block(4, {"/\ud800": [1, 8, [[0, 1]], 0, 1, 0, None]}),
}
"""Lines behind the first one of an index."""


def damaged(path, *strange):
    """Write a log whose index has these lines behind the first one."""
    write_log(path)
    index = Path(f"{path}{SUFFIX}")
    first, *others = index.read_text().splitlines(keepends=True)
    index.write_text("".join([first, *(f"{one}\n" for one in strange), *others]))
    assert count_messages(path) == MESSAGES


@pytest.mark.parametrize("strange", STRANGE.values(), ids=STRANGE)
def test_a_strange_line_costs_no_message(strange, cli, tmp_path):
    damaged(tmp_path / "a.lcmlog", strange)
    assert assert_readable(cli, tmp_path / "a.lcmlog", "info").code == 0


@pytest.mark.parametrize("reader", READERS)
def test_strange_lines_stop_no_command(reader, cli, tmp_path):
    damaged(tmp_path / "a.lcmlog", *STRANGE.values())
    result = assert_readable(cli, tmp_path / "a.lcmlog", reader)
    assert result.code == 0 or reader in ("wtf", "export"), result
