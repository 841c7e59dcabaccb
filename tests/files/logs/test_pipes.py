"""Logs from a pipe: ``zcat x | lcmtools bag info -``, or a command that needs a file says so."""

import os
import threading

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

from lcmtools.bag.writer import LogWriter
from lcmtools.messages.codec import encode
from lcmtools.types.builtin_interfaces import Time
from lcmtools.wire.packet import Packet

MESSAGES = [Packet("/a", encode(Time()), (1_795_000_000 + n) * 1_000_000_000) for n in range(3)]
CONTENT = b"".join(encode_event(number, one) for number, one in enumerate(MESSAGES))


@pytest.mark.parametrize(
    ("words", "there"),
    [
        (("bag", "info", "-"), "in 3 messages"),
        (("bag", "check", "-", "--against", "{}/contract.yaml"), "- meets "),
        (("bag", "du", "-"), "/a"),
        (("bag", "filter", "-", "{}/out.lcmlog", "-t", "/a"), "out.lcmlog: 3 messages"),
        (("bag", "fix", "-", "{}/fixed.lcmlog"), "fixed.lcmlog: 3 messages"),
        (("bag", "export", "-", "{}/out.csv"), "out.csv: 3 messages"),
        (("echo", "-b", "-", "/a"), "sec: 0"),
        (("hz", "-b", "-", "/a"), "average rate: 1.000"),
    ],
    ids=lambda words: " ".join(words[:2]) if isinstance(words, tuple) else "",
)
def test_commands_read_standard_input(words, there, cli, tmp_path):
    (tmp_path / "contract.yaml").write_text("topics: {/a: {min_messages: 3}}\n")
    result = cli(*(word.format(tmp_path) for word in words), input=CONTENT)
    assert result.code == 0, result
    assert there in result.out
    assert "reindex" not in result.out  # which needs a file


def test_an_empty_pipe_is_an_empty_log(cli):
    assert "in 0 messages" in cli("bag", "info", "-", input=b"").ok()


def test_a_compressed_log_and_a_bad_one_are_told_apart(cli, tmp_path):
    with LogWriter(tmp_path / "a.lcmlog.zst", compression="zstd") as log:
        for one in MESSAGES:
            log.add(one)
    content = (tmp_path / "a.lcmlog.zst").read_bytes()
    assert "in 3 messages" in cli("bag", "info", "-", input=content).ok()
    result = cli("bag", "info", "-", input=b"\x1f\x8b rest")
    assert_says(result.err, "not an LCM log", "gzip", "zcat")


def test_a_named_pipe_is_read_to_its_end(cli, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_bytes, args=[CONTENT])
    writer.start()
    assert "in 3 messages" in cli("bag", "info", str(pipe)).ok()
    writer.join()


def test_an_index_needs_a_file(cli):
    result = cli("bag", "reindex", "-", input=CONTENT)
    assert result.code == 1
    assert_says(result.err, "- is not a file", "beside a file")
