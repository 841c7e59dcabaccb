"""Users' messages are values too, whatever their fields are, also in a process that is spawned."""

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from fixtures.message_classes import check_constructor, check_values

import lcmtools
from lcmtools.errors import UnknownType
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.enums import EnumValue
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import fingerprint, message_class, type_files
from lcmtools.packages.type_classes import OwnMessage, find_class

HERE = Path(__file__).parent
FAMILIES = sorted({path.relative_to(HERE).parts[0] for path in HERE.rglob("*.lcm")})


@pytest.mark.parametrize("name", FAMILIES)
def test_every_type_of_a_family_is_a_value(name, family):
    family(name)
    names = list(type_files())
    assert names
    for cls in map(message_class, names):
        assert issubclass(cls, OwnMessage)
        check_values(cls)
        check_constructor(cls)


def test_enums_are_compared_shown_and_copied(family):
    family("enums")
    cls = message_class("rover/state_t")
    field = next(field.attribute for field in fields(cls) if field.name == "mode")
    message = cls(**{field: "RUN"})
    received = decode(cls, encode(message))
    assert received == message
    assert received != cls()
    assert f"{field}=RUN" in repr(received)
    for again in (copy.deepcopy(received), pickle.loads(pickle.dumps(received))):  # noqa: S301 - ours
        assert again == received
        assert getattr(again, field) == "RUN"
    assert isinstance(pickle.loads(pickle.dumps(getattr(received, field))), EnumValue)  # noqa: S301 - ours
    assert lcmtools.from_dict(cls, lcmtools.to_dict(received)) == received


def test_a_pickle_of_a_type_that_has_changed_is_refused(family):
    family("enums")
    cls = message_class("rover/state_t")
    assert find_class("rover/state_t", fingerprint(cls), "") is cls
    with pytest.raises(UnknownType, match="rover/state_t has changed since it was pickled"):
        find_class("rover/state_t", 1, "")
    with pytest.raises(UnknownType, match="unknown type 'rover/no_such_type'"):
        find_class("rover/no_such_type", 1, "")


SPAWNING = """\
import multiprocessing

import lcmtools
from lcmtools.messages.codec import decode, encode

Sighting = lcmtools.message_class("survey/Sighting")


def double(message):
    return type(message)(what=message.what * 2, tags=message.tags, mode=message.mode)


def make(cls):
    return cls(what="made")


if __name__ == "__main__":
    message = Sighting(what="ab", tags=["x"], mode="RUN")
    received = decode(Sighting, encode(message))
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        print(pool.apply(double, (message,)) == double(message))
        print(pool.apply(make, (Sighting,)) == make(Sighting))
        print(pool.apply(double, (received,)))
"""
SIGHTING = """\
package survey;
enum mode_t { IDLE=0, RUN=1 }
struct Sighting { string what; int32_t count; string tags[count]; survey.mode_t mode; }
"""


def test_messages_pass_to_a_spawned_process_and_back(tmp_path, monkeypatch):
    package = tmp_path / "work" / "survey"
    (package / "survey" / "msg").mkdir(parents=True)
    (package / "pyproject.toml").write_text('[project]\nname = "survey"\n[tool.lcmtools]\n')
    (package / "survey" / "msg" / "Sighting.lcm").write_text(SIGHTING)
    (package / "program.py").write_text(SPAWNING)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (elsewhere := tmp_path / "elsewhere").mkdir()
    done = subprocess.run(
        [sys.executable, str(package / "program.py")],
        cwd=elsewhere,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    assert done.stdout == "True\nTrue\nSighting(what='abab', tags=['x'], mode=RUN)\n"
