"""Names, command lines, values and bytes in C++, compared with those in Python."""

import itertools
import subprocess
from collections.abc import Callable, Sequence

import pytest

from lcmtools import __version__
from lcmtools.arguments import split_arguments
from lcmtools.errors import LcmtoolsError
from lcmtools.graph import protocol
from lcmtools.graph.model import CallbackError, Endpoint, NodeInfo, Role
from lcmtools.messages.codec import encode
from lcmtools.messages.setting import read_setting
from lcmtools.names import Resolver
from lcmtools.packages.cmake import cpp_folder
from lcmtools.types import lcmtools_msgs as msgs
from lcmtools.types.rosgraph_msgs import Clock, Log

NAMES = (
    *(
        "a",
        "/a",
        "~a",
        "~",
        "/",
        "",
        "a/b",
        "/a/b/",
        "a//b",
        "~/a",
        "~a/b/",
        "//a",
        "a1",
        "1a",
        "_a",
        "a_",
    ),
    *(
        "a b",
        "a.b",
        "é",
        "a:b",
        "~~a",
        "-a",
        "a-b",
        "/_hidden",
        "A/B",
        "chatter",
        "/husky0/chatter",
    ),
    *("x" * 62, "x" * 63, "x" * 64, "/" + "x" * 63, "a~", "/~a", "a?", "a*", "\u201ca\u201d"),
)
PLACES = (("/", "/node"), ("/husky0", "/husky0/driver"), ("/a/b", "/a/b/c"))
REMAPS = (
    (),
    (("a", "b"),),
    (("a", "b"), ("/a", "/c")),
    (("~a", "/global"), ("chatter", "~private")),
    (("/husky0/chatter", "talk"), ("chatter", "words")),
    (("a", "b c"),),  # illegal, if it is used
    (("a", "x" * 63),),
    (("a/b", "/"), ("/a/", "d")),
)
COMMAND_LINES = (
    *([word] for word in ("a:=b", "__ns:=/h", "__name:=n", "__node:=n", "_gain:=2.0", "_a.b/c:=1")),
    *([word] for word in ("~a:=/b", "/a:=b", "a/b:=c", "a:=", "__ns:=", "__log:=x", "__other:=x")),
    *(
        [word]
        for word in ("a=b", ":=b", "1a:=b", "a b:=c", "é:=c", "_:=x", "_1:=x", "__:=x", "-a:=b")
    ),
    *(
        [word]
        for word in (
            "a:=b:=c",
            "_text:=two words",
            "_text:=a\nb",
            "--gain",
            "-r",
            "--param",
            "--ns",
        )
    ),
    *(
        [word]
        for word in ("--ns=/h", "--ns=", "--name=n", "--domain=3", "--param=a:=1", "--remap=a")
    ),
    *([word] for word in ("-r=a:=b", "--lcm-url=udpm://1.2.3.4:5?ttl=0", "--nsx=/h", "--ns:=/h")),
    *(
        ["--param", value]
        for value in ("gain:=2", "_gain:=2", "~gain:=2", "~/_a:=1", "a.b:=1", "1:=2", "a=b")
    ),
    *(["--remap", value] for value in ("a:=b", "_a:=b", "__ns:=/x", "a", "", "~a:=b", "a.b:=c")),
    ["--ns", "/a", "rest", "b:=c", "--", "d:=e", "--ns", "/b"],
    ["__ns:=/a", "__ns:=/b", "a:=b", "a:=c", "_x:=1", "_x:=2"],
    ["--lcm-url", "tcpq://", "--domain", "3", "-v", "file.txt"],
    [],
)
VALUES = (
    *(
        ("bool", text)
        for text in ("true", "False", "yes", "ON", "0", "1", "2", "", "t", " true ", "'true'")
    ),
    *(
        ("int", text)
        for text in ("1", "-1", "+7", "0x1F", "-0x10", "0b101", "0o17", "007", "5.0", "1e3", "1.5")
    ),
    *(
        ("int", text)
        for text in ("", "-", "--1", "+-1", "1_000", "9223372036854775807", "9223372036854775808")
    ),
    *(
        ("int", text)
        for text in ("-9223372036854775808", "true", "1 ", "inf", "nan", "1e30", "0x", "x1")
    ),
    *(
        ("float", text)
        for text in ("1", "2.0", "-.5", "5.", "1e-3", "1E5", ".inf", "-.inf", "inf", "+inf")
    ),
    *(
        ("float", text)
        for text in (".nan", "nan", "1e400", "1e-400", "0x10", "", ".", "1,5", "1e", "true")
    ),
    *(
        ("float", text)
        for text in ("0.1", "1e22", "123456789.123", "5e-324", "-0.0", "--1", "+-1", "infinity")
    ),
    *(
        ("string", text)
        for text in ("a", "a b", "", "'a'", '"a\\n\\"b"', "'it''s'", "true", "1", " a ", "/a/b-c")
    ),
    *(
        ("string", text)
        for text in ("a: b", "#x", "'", '"', "[1]", "é", "null", "inf", "-", "a\tb", "\\")
    ),
    *(
        ("int[]", text)
        for text in ("[1, 2]", "[]", "[ ]", "[1,2,]", "1", "[a]", "[1", "[0x10]", "[-1, 1e3]")
    ),
    *(("float[]", text) for text in ("[1, 2.5]", "[.inf]", "[x]")),
    *(("bool[]", text) for text in ("[true, no]", "[1, 0]")),
    *(
        ("string[]", text)
        for text in ("[a, b c]", "['a, b', \"c\"]", "[it's]", "['it''s', x]", "[1, true]")
    ),
)

Ask = Callable[[Sequence[Sequence[str]]], list[str]]


@pytest.fixture(scope="session")
def ask(tables):
    """Ask the C++ program questions; an answer begins with "=", an error with "!"."""

    def answers(questions):
        text = "\x1e".join("\x1f".join(words) for words in questions)
        done = subprocess.run([tables], input=text.encode(), capture_output=True, check=True)
        return done.stdout.decode().split("\x1e")[:-1]

    return answers


def _in_python(function):
    try:
        return f"={function()}"
    except LcmtoolsError:
        return "!"


def _same(questions, answers, expected):
    short = ["!" if answer.startswith("!") else answer for answer in answers]
    rows = zip(questions, answers, expected, short, strict=True)
    assert not [(question, said, right) for question, said, right, key in rows if key != right]


def test_names_are_resolved_as_in_python(ask):
    cases = list(itertools.product(PLACES, NAMES, REMAPS))
    questions = [
        ["resolve", *place, name, *itertools.chain(*rules)] for place, name, rules in cases
    ]
    expected = [
        _in_python(lambda p=place, n=name, r=rules: Resolver(*p, r).resolve(n))
        for place, name, rules in cases
    ]
    _same(questions, ask(questions), expected)


def test_command_lines_are_split_as_in_python(ask):
    def told(words):
        said, rest = split_arguments(words)
        return "\x1f".join(
            [
                f"ns={said.namespace or ''}",
                f"name={said.name or ''}",
                f"url={said.lcm_url or ''}",
                f"domain={said.domain or ''}",
                *(f"remap {source}={target}" for source, target in said.remaps),
                *(f"parameter {name}={text}" for name, text in sorted(said.parameters.items())),
                *(f"rest {word}" for word in rest),
            ]
        )

    # an empty list of words cannot be told from one with an empty word
    lines = [words for words in COMMAND_LINES if words]
    questions = [["arguments", *words] for words in lines]
    expected = [_in_python(lambda w=words: told(w)) for words in lines]
    _same(questions, ask(questions), expected)


def test_values_are_read_and_written_as_in_python(ask):
    def value(kind, text):
        try:
            return read_setting(text, kind, "x")
        except LcmtoolsError:
            return None

    answers = ask([["value", kind, text] for kind, text in VALUES])
    rows = [
        (
            kind,
            text,
            answer,
            value(kind, answer[1:]) if answer[0] == "=" else None,
            value(kind, text),
        )
        for (kind, text), answer in zip(VALUES, answers, strict=True)
    ]
    assert not [row for row in rows if repr(row[3]) != repr(row[4])]


def test_messages_have_the_same_bytes_as_in_python(ask):
    frozen, appendable = _messages()
    cases = [(type(one).__name__, encode(one).hex()) for one in frozen]
    assert ask([["bytes", *case] for case in cases]) == [f"={digits}" for _, digits in cases]
    cases = [(type(one).__name__, encode(one)[8:].hex()) for one in appendable]
    rows = zip(cases, ask([["bytes", *case] for case in cases]), strict=True)
    # Python may have appended more fields since
    assert not [case for case, answer in rows if not f"={case[1]}".startswith(answer)]


def test_bytes_after_the_end_of_a_message_are_ignored(ask):
    frozen, _ = _messages()
    cases = [(type(one).__name__, encode(one).hex()) for one in frozen]
    assert ask([["bytes", name, digits + "00ff"] for name, digits in cases]) == [
        f"={digits}" for _, digits in cases
    ]


def test_short_messages_are_refused(ask):
    frozen, _ = _messages()
    questions = [
        ["bytes", type(one).__name__, encode(one)[:end].hex()]
        for one in frozen
        for end in range(0, len(encode(one)), 3)
    ]
    assert {answer[0] for answer in ask(questions)} == {"!"}


@pytest.mark.parametrize(
    "file", ["cmake/lcmtoolsConfigVersion.cmake", "pkgconfig/lcmtools.pc", "lcmtools/context.hpp"]
)
def test_the_version_is_that_of_lcmtools(file):
    assert __version__ in (cpp_folder() / file).read_text()


def _messages():
    """Return messages of all structs that C++ knows: frozen ones, and appendable ones."""
    end = Endpoint(
        "/a",
        Role.SERVICE,
        ("p/A", "p/B"),
        (1, 1 << 63),
        "g",
        5,
        6,
        7,
        8,
        9,
        10,
        11,
        12,
        latched=True,
        rate=1.5,
    )
    error = CallbackError("/a", "KeyError", "'x'", "a.py:3", 4, 5)
    node = NodeInfo(
        "/n/é",
        "id",
        "host",
        7,
        8,
        "a b",
        ports=(9, 10),
        endpoints=(end, end),
        tool=True,
        busy=3,
        errors=(error,),
    )
    payload = protocol.encode_announcement(protocol.Announcement(node, leaving=True, answers=-2))
    announcement = msgs.Announcement.decode(payload)
    request, reply = msgs.ServiceRequest(), msgs.ServiceReply()
    request.client, request.sequence, request.payload = "me", 3, b"\0\1\2"
    reply.client, reply.sequence, reply.status, reply.error = "me", 3, 1, "no"
    reply.payload = b"\xff"
    parameter = msgs.Parameter()
    parameter.name, parameter.type, parameter.value, parameter.read_only = "a", "int", "3", True
    asked, told = msgs.Parameters_Request(), msgs.Parameters_Response()
    asked.changes, told.parameters, told.errors = [parameter], [parameter, parameter], ["bad", ""]
    log, clock = Log(), Clock()
    log.header.stamp.sec, log.msg, log.line, log.topics = 4, "text", 12, ["/a", "/b"]
    clock.clock.sec, clock.clock.nsec = -1, 999_999_999
    probe = msgs.Probe.decode(protocol.encode_probe(protocol.Probe("/n", -5)))
    shutdown = msgs.Shutdown.decode(protocol.encode_shutdown(protocol.Shutdown("id", 5, "who")))
    details = msgs.NodeDetails.decode(_with_hash(msgs.NodeDetails, announcement.details))
    ends = [msgs.Endpoint.decode(_with_hash(msgs.Endpoint, one.data)) for one in details.endpoints]
    errors = [
        msgs.CallbackError.decode(_with_hash(msgs.CallbackError, one.data))
        for one in details.errors
    ]
    frozen = [announcement, request, reply, asked, told, log, clock, probe, shutdown]
    return frozen, [details, *ends, *errors]


def _with_hash(kind, data):
    return kind._get_packed_fingerprint() + data
