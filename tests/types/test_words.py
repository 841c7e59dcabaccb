"""Fields, types and packages with names that Python cannot spell, and C and Java can."""

import re
import subprocess

import pytest

from lcmtools import message_class
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import constants, fields
from lcmtools.messages.filter import Filter
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.path import parse_path, select
from lcmtools.messages.plain import to_json, to_plain
from lcmtools.messages.python_names import python_name
from lcmtools.messages.registry import fingerprint, service_class, type_name
from lcmtools.messages.text import format_message
from lcmtools.packages.lcm_gen import find_lcm_gen
from lcmtools.packages.user_types import package_messages

TYPES = ("lambda/pass", "lambda/global", "def/class", "from", "global/Query")
VALUES = (
    "{from: 7, lambda: [[1, 2], [3, 4]], g: {a: 1, c: [{import: 5, __x: 6, get_hash: 8}, {}]},"
    " decode: word, in_: 1, in: true, class: [1, 2, 3]}"
)


@pytest.mark.parametrize(
    ("name", "spelled"),
    [
        ("x", "x"),
        ("from", "from_"),
        ("from_", "from_"),
        ("None", "None_"),
        ("encode", "encode_"),
        ("match", "match"),
        ("__x", "__x__"),
        ("__init__", "__init___"),
        ("__slots__", "__slots___"),
    ],
)
def test_python_has_names_of_its_own_where_it_must(name, spelled):
    assert python_name(name) == spelled


def test_another_field_has_its_python_name_first(family):
    family("words")
    cls = message_class("lambda/pass")
    names = {field.name: field.attribute for field in fields(cls)}
    assert (names["in"], names["in_"], names["encode"]) == ("in__", "in_", "encode_")


def test_types_are_called_by_their_own_names(family):
    family("words")
    assert [type_name(message_class(name)) for name in TYPES] == list(TYPES)


def test_fingerprints_are_those_of_lcm_gens_c(family, tmp_path):
    folder = family("words")
    own = {}
    for file in folder.glob("*.lcm"):
        program = [find_lcm_gen(), "--c", "--c-cpath", tmp_path, "--c-hpath", tmp_path, file]
        subprocess.run(program, check=True)
    for code in tmp_path.glob("*.c"):
        hashed = re.search(r"= \(uint64_t\)(0x\w+?)LL", code.read_text())
        own[code.stem] = int(hashed[1], 16) if hashed else 0

    def rotated(base, *nested):
        total = (base + sum(nested)) % 2**64
        return (total << 1) % 2**64 + (total >> 63)

    inner = rotated(own["def_class"])
    middle = rotated(own["lambda_global"], inner)
    outer = rotated(own["lambda_pass"], middle)
    expected = {"def/class": inner, "lambda/global": middle, "lambda/pass": outer}
    expected["from"] = rotated(own["from"], outer)
    assert {name: fingerprint(message_class(name)) for name in expected} == expected


def test_values_go_in_and_come_out_under_their_own_names(family):
    family("words")
    cls = message_class("lambda/pass")
    message = draft_from_values(cls, [VALUES]).message
    assert (message.from_, message.in_, message.in__, message.decode_) == (7, 1, True, "word")
    payload = encode(message)
    again = decode(cls, payload)
    assert to_plain(again)["g"] == {
        "a": 1,
        "c": [{"import": 5, "__x": 6, "get_hash": 8}, {"import": 0, "__x": 0, "get_hash": 0}],
    }
    for text in (format_message(again), to_json(again)):
        assert encode(draft_from_values(cls, [text]).message) == payload
    assert again.encode() == payload, "lcm-gen's own code writes the same"


def test_constants_have_their_own_names(family):
    family("words")
    assert constants(message_class("lambda/pass")) == {"def": 3, "None": 4, "is": 2.5}
    assert constants(message_class("global/Query")) == {"pass": "word"}


@pytest.mark.parametrize("path", ["from", "from_", "/from", ".from"])
def test_a_path_takes_the_own_name_and_the_one_in_python(family, path):
    family("words")
    message = message_class("lambda/pass")()
    message.from_ = 5
    assert select(message, parse_path(path)).value == 5


@pytest.mark.parametrize(
    ("text", "matches"),
    [
        ("m.from == 7", True),
        ("from == 7 and m.in", True),
        ("m.from in [1, 7]", True),
        ("m.lambda[0][1] > 1.5 and not m.in", False),
        ("m.class[2] == 3 or m.from == 1", True),
        ("m.g.c[0].import == 5 and m.encode == 2", True),
        ("decode == 'from'", False),
        ("m.decode != 'm.in \\' from' and m.from>6.5", True),
        ("m.from_ == m.from", True),
    ],
)
def test_filters_take_the_own_names(family, text, matches):
    family("words")
    message = draft_from_values(message_class("lambda/pass"), [VALUES]).message
    payload = encode(message)
    assert Filter(text).matches(decode(message_class("lambda/pass"), payload)) is matches


def test_services_are_found(family):
    family("words")
    assert service_class("lambda/while").Request.__slots__ == ["x"]
    assert type_name(service_class("lambda/return").Response) == "lambda/return_Response"


def test_commands_show_and_export_them(family, cli, log_of, tmp_path):
    family("words")
    message = draft_from_values(message_class("lambda/pass"), [VALUES]).message
    log = log_of("PASS", encode(message))
    assert cli("echo", "-b", log, "PASS/from").out == "7\n---\n"
    assert cli("echo", "-b", log, "PASS", "--filter", "m.from > 7").out == ""
    cli("bag", "export", log, str(tmp_path / "words.csv")).ok()
    heading, _ = (tmp_path / "words.csv").read_text().splitlines()
    assert {"field.from", "field.in", "field.class0"} <= set(heading.split(","))


def test_a_package_has_them_under_their_python_names(family):
    folder = family("words")
    find = package_messages("global.msg", str(folder / "global" / "msg" / "__init__.py"))
    assert type_name(find("Query")) == "global/Query"
    find = package_messages("lambda", str(folder / "__init__.py"))
    assert find("pass_") is message_class("lambda/pass")
    with pytest.raises(AttributeError, match="unknown type 'lambda/from'"):
        find("from_")
