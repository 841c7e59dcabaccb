"""Enums, which lcm-gen's own Python code cannot create: shown by name, taken by name or number."""

import json
import os
import shutil
import subprocess
import sysconfig
from io import BytesIO
from pathlib import Path

import pytest

import lcmtools
from lcmtools.errors import UnknownType, ValueMismatch
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.definition import definition, prototype
from lcmtools.messages.fill import fill
from lcmtools.messages.filter import Filter
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import fingerprint, message_class, type_names
from lcmtools.messages.supply import set_supply
from lcmtools.messages.text import Writer, format_message
from lcmtools.packages import provide_user_types

HERE = Path(__file__).parent
FILES = sorted((HERE / "enums").rglob("*.lcm"))
PACKAGES = Path(sysconfig.get_path("purelib"))

RANGER = {
    "utime": 7,
    "state": {"mode": "OFF"},
    "mode": "FAST",
    "light": "GREEN",
    "level": 99,
}
LISTS = {
    "fixed": ["RUN", "FAST"],
    "varied": ["IDLE", "RUN", 5],
    "grid": [["LOW", "LOW", "LOW"], ["HIGH", "HIGH", "HIGH"]],
}


@pytest.fixture(autouse=True)
def types(monkeypatch, tmp_path_factory):
    """The types of this family as a user's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(HERE / "enums"))
    provide_user_types()
    yield
    set_supply(None)


def made(name, value):
    message = lcmtools.message_class(name)()
    fill(message, value)
    return message


def generate(language, folder):
    program = PACKAGES / "bin" / "lcm-gen"
    for file in FILES:  # one by one: a package would apply to the next file
        subprocess.run([program, f"--{language}", file], cwd=folder, check=True)


def test_messages_are_those_of_lcm_gens_java(tmp_path):
    jar = PACKAGES / "share/java/lcm.jar"
    java, compiler = shutil.which("java"), shutil.which("javac")
    if not java or not compiler or not jar.exists():
        pytest.skip("no Java to run Java programs with")
    generate("java", tmp_path)
    path = f"{jar}{os.pathsep}{tmp_path}"
    sources = [
        HERE / "Enums.java",
        *(tmp_path / "rover").iterdir(),
        *(tmp_path / "other").iterdir(),
    ]
    subprocess.run([compiler, "-cp", path, "-d", tmp_path, *sources], check=True)
    run = [java, "-Xshare:auto", "-XX:TieredStopAtLevel=1", "-cp", path, "Enums"]
    theirs = subprocess.run(run, check=True, capture_output=True, text=True).stdout.split()
    ours = [made("rover/ranger_t", RANGER), made("rover/lists_t", LISTS)]
    assert [encode(message).hex() for message in ours] == theirs
    back = [
        decode(type(message), bytes.fromhex(t)) for message, t in zip(ours, theirs, strict=True)
    ]
    assert list(map(to_plain, back)) == [RANGER, LISTS]


def test_messages_are_those_of_lcm_gens_c(tmp_path):
    compiler = shutil.which("gcc") or pytest.skip("no gcc to compile C programs with")
    generate("c", tmp_path)
    sources = [HERE / "enums.c", *tmp_path.glob("*.c")]
    options = [f"-I{tmp_path}", f"-I{PACKAGES / 'include'}", f"-L{PACKAGES / 'lib'}"]
    options += [f"-Wl,-rpath,{PACKAGES / 'lib'}", "-llcm"]
    subprocess.run([compiler, "-o", tmp_path / "enums", *sources, *options], check=True)
    theirs = subprocess.run([tmp_path / "enums"], check=True, capture_output=True, text=True)
    assert encode(made("rover/ranger_t", RANGER)).hex() == theirs.stdout


def test_a_type_without_a_package_may_have_an_enum():
    assert to_plain(made("holder_t", {"bare": "SOME"})) == {"bare": "SOME"}
    assert "rover/mode_t" not in type_names(), "an enum is not a message"
    with pytest.raises(UnknownType, match="it is an enum"):
        message_class("rover/mode_t")


def test_enums_are_shown_by_name():
    cls = lcmtools.message_class("rover/lists_t")
    assert definition(cls).splitlines()[:5] == [
        "rover/mode_t[2] fixed",
        "  int32 IDLE=0",
        "  int32 RUN=1",
        "  int32 FAST=2",
        "  int32 OFF=-7",
    ]
    assert prototype(lcmtools.message_class("rover/state_t")) == "mode: IDLE"
    for name, value in (("rover/ranger_t", RANGER), ("rover/lists_t", LISTS)):
        message = made(name, value)
        assert format_message(message) == Writer().block(to_plain(message))
    assert format_message(made("rover/state_t", {"mode": 2})) == 'mode: "FAST"'


@pytest.mark.parametrize("value", ["FAST", "+2", 2, "0x2"])
def test_enums_are_taken_by_name_and_by_number(value):
    message = made("rover/state_t", {"mode": value})
    assert message.mode == 2


@pytest.mark.parametrize("value", ["FASTER", "fast", 1 << 31, 0.5, [1]])
def test_other_values_are_refused(value):
    with pytest.raises(ValueMismatch, match="mode: "):
        made("rover/state_t", {"mode": value})


def test_python_code_may_use_names_numbers_and_values():
    cls = lcmtools.message_class("rover/state_t")
    message = cls()
    assert (message.mode, message.mode == "IDLE", message.mode == "RUN") == (0, True, False)
    payloads = set()
    for value in ("RUN", 1, type(message.mode).RUN):
        message.mode = value
        payloads.add(encode(message))
        payloads.add(message.encode())
    (payload,) = payloads
    back = decode(cls, payload)
    assert (str(back.mode), back.mode == "RUN", back.mode != "RUN") == ("RUN", True, False)
    assert type(back.mode) is type(cls().mode)
    theirs = cls.decode(BytesIO(payload))
    assert theirs.mode == 1
    assert fingerprint(cls) == int.from_bytes(payload[:8], "big")


def test_received_arrays_have_values_with_names():
    cls = lcmtools.message_class("rover/lists_t")
    back = decode(cls, encode(made("rover/lists_t", LISTS)))
    assert [str(back.fixed), str(back.varied)] == ["[RUN, FAST]", "[IDLE, RUN, 5]"]
    assert (back.fixed[0] == "RUN", back.varied[0] == type(back.fixed[0]).IDLE) == (True, True)
    assert "grid=[[LOW, LOW, LOW], [HIGH, HIGH, HIGH]]" in repr(back)
    assert lcmtools.to_dict(back) == LISTS
    assert encode(back) == encode(made("rover/lists_t", LISTS)) == back.encode()


@pytest.mark.parametrize(
    ("expression", "matches"),
    [
        ("m.mode == 'FAST'", True),
        ("m.mode != 'FAST'", False),
        ("m.mode == 2", True),
        ("mode > 1 and state.mode in ('OFF', 'RUN')", True),
        ("light == 'RED'", False),
        ("m.mode == m.FAST", True),
        ("mode == m.RUN or state.mode != state.OFF", False),
        ("RUN < mode <= m.FAST and m.state.mode == m.state.OFF", True),
    ],
)
def test_filters_compare_with_names_and_numbers(expression, *, matches):
    assert Filter(expression).matches(made("rover/ranger_t", RANGER)) is matches


def test_commands_take_and_show_names(cli):
    shown = cli("msg", "proto", "--json", "rover/ranger_t").ok()
    assert json.loads(shown) == {**RANGER, "utime": 0, "state": {"mode": "IDLE"}} | {
        "mode": "IDLE",
        "light": 0,  # lcm-gen counts from 1
        "level": 0,
    }


def test_code_is_generated_for_the_enums_too(tmp_path, cli):
    made = cli("msg", "generate", "--lang", "c", str(tmp_path), "rover/state_t").out.split()
    assert str(tmp_path / "rover_mode_t.h") in made


@pytest.mark.parametrize("words", [["rover/mode_t"], ["rover"], []])
def test_an_enum_is_generated_if_it_its_package_or_all_types_are_meant(words, tmp_path, cli):
    made = cli("msg", "generate", "--lang", "cpp", str(tmp_path), *words).out.split()
    assert str(tmp_path / "rover/mode_t.hpp") in made
    assert (str(tmp_path / "rover/state_t.hpp") in made) is (words != ["rover/mode_t"])


def test_another_version_of_a_type_may_have_an_enum_of_elsewhere(tmp_path, monkeypatch):
    for name, text in (
        ("mode_t.lcm", "enum mode_t { IDLE=0, RUN=1 }"),
        ("new/state_t.lcm", "struct state_t { mode_t mode; }"),
        ("old/state_t.lcm", "struct state_t { int8_t id; mode_t mode; }"),
    ):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"package rover;\n{text}\n")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    provide_user_types()
    old = made("rover/state_t@old/state_t.lcm", {"id": 3, "mode": "RUN"})
    assert to_plain(decode(type(old), encode(old))) == {"id": 3, "mode": "RUN"}
    assert to_plain(made("rover/state_t", {"mode": "RUN"})) == {"mode": "RUN"}
