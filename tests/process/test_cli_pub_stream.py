"""pub from files and from standard input, as it comes."""

import json
import os
import subprocess
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]
STRING = "std_msgs/String"
THREE = "data: one\n---\ndata: two\n---\n{data: three}\n"

pytestmark = pytest.mark.usefixtures("use_module_bus")
_topics = count()


@pytest.fixture
def topic() -> str:
    """A topic of the test's own."""
    return f"/stream{next(_topics)}"


@pytest.fixture
def heard(topic: str, module_start: Callable[..., Any], lcmtools_path: str, lcmtools: Run) -> Any:
    """``heard()``: the data of all messages that an echo on the topic has heard."""
    echo = module_start(lcmtools_path, "echo", "--json", topic)

    def texts() -> list[str]:
        lcmtools("pub", "-1", topic, STRING, "the end")
        echo.wait_for("the end")
        found = [json.loads(line)["data"] for line in echo.lines if line.startswith("{")]
        return [text for text in found if text != "the end"]

    return texts


@pytest.fixture
def feed(lcmtools_path: str) -> Iterator[Callable[..., Any]]:
    """``feed(*arguments)``: a running pub -v with a pipe for standard input."""
    started: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> subprocess.Popen[str]:
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
def test_several_documents_are_sent_in_order(
    source: str, topic: str, heard: Any, lcmtools: Run, tmp_path: Path
) -> None:
    file = tmp_path / "messages.yaml"
    file.write_text(THREE)
    words = {"-f file": ["-f", str(file)], "-f -": ["-f", "-"], "-": ["-"], "nothing": []}[source]
    result = lcmtools("pub", "-r", "50", topic, STRING, *words, stdin=THREE)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert heard() == ["one", "two", "three"]


@pytest.mark.parametrize(
    ("words", "sent"),
    [
        (["-1"], ["one"]),
        (["-t", "2", "-r", "50"], ["one", "two"]),
        (["-t", "5", "-r", "50"], ["one", "two", "three", "one", "two"]),
    ],
)
def test_a_file_is_sent_so_many_times_as_asked(
    words: list[str], sent: list[str], topic: str, heard: Any, lcmtools: Run, tmp_path: Path
) -> None:
    file = tmp_path / "messages.yaml"
    file.write_text(THREE)
    assert lcmtools("pub", *words, "-f", str(file), topic, STRING).returncode == 0
    assert heard() == sent


def test_a_stream_ends_after_as_many_messages_as_asked(
    topic: str, heard: Any, lcmtools: Run
) -> None:
    assert lcmtools("pub", "-1", topic, STRING, "-", stdin=THREE).returncode == 0
    assert lcmtools("pub", "-t", "2", topic, STRING, "-", stdin=THREE).returncode == 0
    assert heard() == ["one", "one", "two"]


@pytest.mark.parametrize(
    "texts",
    [
        ['{"data": "a"}\n', '{"data": "b"}\n'],
        ["data: a\n---\n", "data: b\n---\n"],
        ['data: "a"\n---\n', 'data: "b"\n---\n'],
        ['{\n  "data": "a"\n}\n', '{\n  "data": "b"\n}\n'],
    ],
)
def test_each_message_is_sent_as_soon_as_it_is_whole(
    texts: list[str], topic: str, feed: Callable[..., Any]
) -> None:
    pub = feed(topic, STRING, "-")
    for number, (text, data) in enumerate(zip(texts, "ab", strict=True), 1):
        pub.stdin.write(text)
        pub.stdin.flush()
        assert pub.stderr.readline() == f'publishing #{number}: {{"data":"{data}"}}\n'
    pub.stdin.close()
    assert pub.wait() == 0


def test_echo_and_pub_are_a_live_relay(
    topic: str, start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    relay = start(
        "sh",
        "-c",
        f"{lcmtools_path} echo --json {topic} | {lcmtools_path} pub -w 0 /relayed {STRING} -",
    )
    echo = start(lcmtools_path, "echo", "/relayed")
    for text in ("first", "second"):
        assert lcmtools("pub", "-1", "-w", "1", topic, STRING, text).returncode == 0
        assert echo.wait_for(text) == f'data: "{text}"'
    assert relay.lines == []


def test_what_echo_prints_can_be_published_again(topic: str, lcmtools: Run) -> None:
    printed = (
        "linear: \n  x: 0.5\n  y: 0.0\n  z: 0.0\nangular: \n  x: 0.0\n  y: 0.0\n  z: -0.3\n---\n"
    )
    result = lcmtools("pub", "-v", "-w", "0", topic, "geometry_msgs/Twist", "-", stdin=printed * 2)
    assert result.returncode == 0
    assert result.stderr.splitlines()[1] == (
        'publishing #2: {"linear":{"x":0.5,"y":0.0,"z":0.0},"angular":{"x":0.0,"y":0.0,"z":-0.3}}'
    )


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
            '{"data": "a"}\n{"data": \n---\n',
            1,
            (
                "standard input: document 2: bad YAML from line 2 on: a bracket is not closed;"
                " 1 message has been sent"
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
            "standard input has no message in it; write YAML documents, separated by ---",
        ),
    ],
)
def test_an_error_in_a_stream_says_where_it_is_and_what_has_been_sent(
    text: str, code: int, line: str, topic: str, lcmtools: Run
) -> None:
    result = lcmtools("pub", "-w", "0", topic, STRING, "-", stdin=text)
    assert (result.returncode, result.stdout, result.stderr) == (
        code,
        "",
        f"lcmtools pub: {line}\n",
    )


def test_a_stream_that_is_no_utf_8_is_refused(topic: str, lcmtools_path: str) -> None:
    result = subprocess.run(
        [lcmtools_path, "pub", "-w", "0", topic, STRING, "-"],
        input=b"data: a\n---\ndata: caf\xe9\n",
        capture_output=True,
        check=False,
    )
    assert result.returncode == 1
    assert result.stderr.decode() == (
        "lcmtools pub: cannot read standard input: it is not UTF-8 text; 1 message has been sent\n"
    )


def test_waiting_for_a_stream_is_announced(topic: str, feed: Callable[..., Any]) -> None:
    pub = feed(topic, STRING, "-")
    assert pub.stderr.readline() == "lcmtools pub: waiting for messages on standard input\n"


def test_one_message_in_a_file_is_repeated(
    topic: str, start: Callable[..., Any], lcmtools_path: str, tmp_path: Path
) -> None:
    file = tmp_path / "one.yaml"
    file.write_text("data: x\n")
    pub = start(lcmtools_path, "pub", "-v", "-w", "0", "-f", str(file), topic, STRING)
    assert (
        pub.wait_for("publishing") == "publishing the one message 10 times a second, until Ctrl-C"
    )
    pub.wait_for("publishing #3: ")


def test_the_last_of_a_stream_is_latched(
    topic: str, start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    pub = start(
        "sh",
        "-c",
        f"printf 'data: a\\n---\\ndata: b' | {lcmtools_path} pub -v -l -w 0 {topic} {STRING} -",
    )
    pub.wait_for("publishing #2: ")
    result = lcmtools("echo", "-1", "--timeout", "5s", topic)
    assert result.stdout == 'data: "b"\n---\n'


def test_a_pipe_that_has_nothing_means_the_default_message(
    topic: str, heard: Any, lcmtools: Run
) -> None:
    assert lcmtools("pub", "-1", topic, STRING, stdin="").returncode == 0
    assert heard() == [""]


def test_a_named_pipe_is_a_stream(topic: str, feed: Callable[..., Any], tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    pub = feed("-f", str(pipe), topic, STRING)
    with pipe.open("w") as writer:
        writer.write("data: a\n---\n")
        writer.flush()
        assert pub.stderr.readline() == 'publishing #1: {"data":"a"}\n'
    assert pub.wait() == 0
