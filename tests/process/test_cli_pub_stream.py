"""pub from files and from standard input, as it comes."""

import os
import shlex
import subprocess
from contextlib import suppress
from itertools import count

import pytest
from fixtures.says import assert_line, assert_says

from lcmtools.publish import incoming

STRING = "std_msgs/String"
THREE = "data: one\n---\ndata: two\n---\n{data: three}\n"

pytestmark = pytest.mark.usefixtures("use_module_bus")
_topics = count()


@pytest.fixture
def topic():
    """A topic of the test's own."""
    return f"/stream{next(_topics)}"


@pytest.fixture
def received(topic, receiver):
    """``received()``: the data of all messages on the topic."""
    messages = receiver.subscribe(topic)
    return lambda: [message["data"] for message in messages()]


@pytest.fixture
def feed(lcmtools_path):
    """``feed(*arguments)``: a running pub -v with a pipe for standard input."""
    started = []

    def start(*arguments):
        process = subprocess.Popen(
            [lcmtools_path, "pub", "-v", "-w", "0", *arguments],
            stdin=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.wait(40)
        for stream in (process.stdin, process.stderr):
            assert stream is not None
            with suppress(BrokenPipeError):
                stream.close()


@pytest.mark.parametrize("source", ["-f file", "-f -", "-", "nothing"])
def test_several_documents_are_sent_in_order(source, topic, received, cli, tmp_path):
    file = tmp_path / "messages.yaml"
    file.write_text(THREE)
    words = {"-f file": ["-f", str(file)], "-f -": ["-f", "-"], "-": ["-"], "nothing": []}[source]
    assert cli("pub", "-r", "50", topic, STRING, *words, input=THREE).ok() == ""
    assert received() == ["one", "two", "three"]


@pytest.mark.parametrize(
    ("words", "sent"),
    [
        (["-1"], ["one"]),
        (["-t", "2", "-r", "50"], ["one", "two"]),
        (["-t", "5", "-r", "50"], ["one", "two", "three", "one", "two"]),
    ],
)
def test_a_file_is_sent_so_many_times_as_asked(words, sent, topic, received, cli, tmp_path):
    file = tmp_path / "messages.yaml"
    file.write_text(THREE)
    assert cli("pub", *words, "-f", str(file), topic, STRING).ok() == ""
    assert received() == sent


def test_a_stream_ends_after_as_many_messages_as_asked(topic, received, cli):
    assert cli("pub", "-1", topic, STRING, "-", input=THREE).code == 0
    assert cli("pub", "-t", "2", topic, STRING, "-", input=THREE).code == 0
    assert received() == ["one", "one", "two"]


def test_each_message_is_sent_as_soon_as_it_is_whole(topic, feed):
    pub = feed(topic, STRING, "-")
    texts = [
        *('{"data": "a"}\n', "data: a\n---\n", 'data: "a"\n---\n', '{\n  "data": "a"\n}\n'),
        "data: a\n---\n",
    ]
    for number, text in enumerate(texts, 1):
        pub.stdin.write(text)
        pub.stdin.flush()
        assert pub.stderr.readline() == f'publishing #{number}: {{"data":"a"}}\n'
    pub.stdin.close()
    assert pub.wait() == 0


def test_echo_and_pub_are_a_live_relay(topic, start, cli, receiver, lcmtools_path):
    relayed = receiver.subscribe("/relayed")
    path = shlex.quote(lcmtools_path)
    line = f"{path} echo --json {topic} | {path} pub -v -w 0 /relayed {STRING} -"
    relay = start("sh", "-c", line)
    for text in ("first", "second"):
        assert cli("pub", "-1", "-w", "1", topic, STRING, text).code == 0
        relay.wait_for(text)
        assert relayed()[-1] == {"data": text}
    assert all(line.startswith("publishing #") for line in relay.lines)


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (
            "data: a\n---\ndata: b\n---\n\ndta: c\n---\ndata: d\n",
            1,
            (
                "standard input: document 3, line 6: dta: std_msgs/String has no field 'dta'"
                " (fields: data); did you mean 'data'?; 2 messages have been sent"
            ),
        ),
        (
            "data: [a]\n---\n",
            2,
            "standard input: document 1, line 1: data: expected text, got a list",
        ),
        (
            "# nothing\n---\n",
            2,
            "standard input does not contain a message; write YAML documents, separated by ---",
        ),
    ],
)
def test_an_error_in_a_stream_says_where_it_is_and_what_has_been_sent(text, code, line, topic, cli):
    result = cli("pub", "-w", "0", topic, STRING, "-", input=text)
    assert (result.code, result.out, result.err) == (code, "", f"lcmtools pub: {line}\n")


def test_a_stream_that_is_no_utf_8_is_refused(topic, cli):
    result = cli("pub", "-w", "0", topic, STRING, "-", input=b"data: a\n---\ndata: caf\xe9\n")
    assert result.code == 1
    assert_line(result.err, "lcmtools pub: ", "standard input: ", "UTF-8", "; 1 message")


def test_waiting_for_a_stream_is_announced(topic, cli, tmp_path, monkeypatch):
    monkeypatch.setattr(incoming, "_PATIENCE", 0.1)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = os.open(pipe, os.O_RDWR)
    waits = f"lcmtools pub: waiting for messages on {pipe}\n"
    result = cli("pub", "-w", "0", "-f", str(pipe), topic, STRING, until=waits)
    os.close(writer)
    assert (result.code, result.err) == (130, waits)


def test_one_message_in_a_file_is_repeated(topic, cli, tmp_path):
    file = tmp_path / "one.yaml"
    file.write_text("data: x\n")
    words = ("-v", "-w", "0", "-f", str(file), topic, STRING)
    result = cli("pub", *words, until="publishing #3: ")
    assert result.code == 130
    assert_says(result.err, "single message", "10 times a second", "Ctrl-C\npublishing #1: ")


def test_the_last_of_a_stream_is_latched(topic, receiver, cli):
    late = []

    def has_come(written):
        if "publishing #2: " in written and not late:
            late.append(receiver.subscribe(topic))
        return bool(late and late[0]())

    words = ("-v", "-l", "-w", "0", topic, STRING, "-")
    result = cli("pub", *words, input="data: a\n---\ndata: b", until=has_come)
    assert result.code == 130
    assert late[0]() == [{"data": "b"}]


def test_a_pipe_that_has_nothing_means_the_default_message(topic, received, cli):
    assert cli("pub", "-1", topic, STRING, input="").ok() == ""
    assert received() == [""]


def test_a_named_pipe_is_a_stream(topic, feed, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    pub = feed("-f", str(pipe), topic, STRING)
    with pipe.open("w") as writer:
        writer.write("data: a\n---\n")
        writer.flush()
        assert pub.stderr.readline() == 'publishing #1: {"data":"a"}\n'
    assert pub.wait() == 0
