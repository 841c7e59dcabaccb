"""Finding types by name, by class and by fingerprint."""

import subprocess
import sys

import pytest

from lcmtools.errors import UnknownType
from lcmtools.messages.registry import (
    Registry,
    TypeSource,
    candidates,
    message_class,
    packages,
    service_class,
    service_name,
    service_names,
    type_names,
)
from lcmtools.messages.type_names import near_miss
from lcmtools.types.fingerprints import FINGERPRINTS, SERVICES
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_srvs import Trigger


@pytest.mark.parametrize(
    "name",
    [
        "geometry_msgs/Twist",
        "geometry_msgs/msg/Twist",
        "geometry_msgs.Twist",
        "geometry_msgs.msg.Twist",
        "Twist",
    ],
)
def test_a_type_is_found_however_its_name_is_written(name):
    assert message_class(name) is Twist


@pytest.mark.parametrize(
    ("name", "line"),
    [
        (
            "geometry_msgs/Twst",
            "unknown type 'geometry_msgs/Twst'; did you mean geometry_msgs/Twist?",
        ),
        ("twist", "unknown type 'twist'; did you mean geometry_msgs/Twist?"),
        ("std_msgs/Twist", "unknown type 'std_msgs/Twist'; did you mean geometry_msgs/Twist?"),
        (
            "geometry_msg/msg/Twist",
            "unknown type 'geometry_msg/msg/Twist'; did you mean geometry_msgs/Twist?",
        ),
        ("std_msgs/Tme", "unknown type 'std_msgs/Tme'; did you mean std_msgs/Time?"),
        (
            "Tme",
            "unknown type 'Tme'; did you mean builtin_interfaces/Time or std_msgs/Time?",
        ),
        ("Zzzzzz", "unknown type 'Zzzzzz'; see: lcmtools msg list"),
        (
            "geometry_msgs/",
            (
                "unknown type 'geometry_msgs/'; it is a package: lcmtools msg package geometry_msgs"
                " lists its types"
            ),
        ),
        ("lab/Foo.msg", "unknown type 'lab/Foo.msg'; write a type as lab/Foo"),
        ("{x: 1}", "unknown type '{x: 1}'; write a type as geometry_msgs/Twist"),
        ("", "unknown type ''; see: lcmtools msg list"),
        ("a/b/c/Twisted_", "unknown type 'a/b/c/Twisted_'; did you mean geometry_msgs/Twist?"),
        ("Time", "several types are called 'Time'; write builtin_interfaces/Time or std_msgs/Time"),
        (
            "std_srvs/Trigger",
            (
                "unknown type 'std_srvs/Trigger'; std_srvs/Trigger is a service; "
                "its messages are std_srvs/Trigger_Request and _Response"
            ),
        ),
    ],
)
def test_an_unknown_type_names_what_may_be_meant(name, line):
    with pytest.raises(UnknownType) as caught:
        message_class(name)
    assert str(caught.value) == line


@pytest.mark.parametrize("name", ["std_srvs/Trigger", "std_srvs/srv/Trigger", "Trigger"])
def test_a_service_is_found_however_its_name_is_written(name):
    assert service_class(name).Request is Trigger.Request
    assert service_class(name).__name__ == "Trigger"


@pytest.mark.parametrize(
    ("name", "line"),
    [
        (
            "std_srvs/Trigg",
            "unknown service type 'std_srvs/Trigg'; did you mean std_srvs/Trigger?",
        ),
        (
            "Zzzzzz",
            "unknown service type 'Zzzzzz'; see: lcmtools srv list",
        ),
    ],
)
def test_an_unknown_service_names_what_may_be_meant(name, line):
    with pytest.raises(UnknownType) as caught:
        service_class(name)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("geometry_msgs/Point", ["geometry_msgs/Vector3", "geometry_msgs/Point"]),
        ("geometry_msgs/Accel", ["geometry_msgs/Twist", "geometry_msgs/Accel"]),
        ("std_msgs/UInt32", ["std_msgs/Int32", "std_msgs/UInt32"]),
        ("std_msgs/Duration", ["std_msgs/Time", "std_msgs/Duration"]),
        ("std_msgs/Bool", ["std_msgs/Bool", "std_srvs/SetBool_Request"]),
    ],
)
def test_the_likeliest_type_of_a_fingerprint_comes_first(name, expected):
    assert candidates(FINGERPRINTS[name]) == expected


def test_an_unknown_fingerprint_has_no_candidates():
    assert candidates(1) == []


def test_all_types_and_services_are_listed_in_order():
    assert type_names() == sorted(FINGERPRINTS)
    assert service_names() == sorted(SERVICES)
    assert {"std_srvs/Empty", "std_srvs/SetBool", "std_srvs/Trigger"} <= set(service_names())
    assert packages() == sorted({name.split("/")[0] for name in FINGERPRINTS})


@pytest.mark.parametrize("name", ["std_srvs/Trigger", "std_srvs/srv/Trigger", "Trigger"])
def test_a_services_full_name_is_found_from_every_spelling(name):
    assert service_name(name) == "std_srvs/Trigger"


def test_an_earlier_source_hides_a_type_of_the_same_name():
    ours = TypeSource("lcmtools.types", {"std_msgs/String": 1})
    theirs = TypeSource("elsewhere", {"std_msgs/String": 2, "b/Other": 3})
    registry = Registry([ours, theirs])
    assert registry.type_names() == ["b/Other", "std_msgs/String"]
    assert registry.candidates(1) == ["std_msgs/String"]
    assert registry.candidates(2) == ["std_msgs/String"], "found by its fingerprint all the same"
    assert registry.message_class("String") is message_class("std_msgs/String")


class _Supply:
    """A user's own types; who asks for those of installed packages waits for a disk."""

    def workspace(self):
        return TypeSource("lcmtools.types", {"my_msgs/Bump": 7}, ["my_srvs/Go"])

    def installed(self):
        raise AssertionError("asked without need")

    def recorded_names(self, _):
        return []

    def recorded(self):
        raise AssertionError("asked without need")

    def add_start(self, _):
        raise AssertionError("asked without need")


def test_a_type_of_the_workspace_is_found_without_looking_at_installed_packages(monkeypatch):
    monkeypatch.setattr("lcmtools.messages.registry._load", lambda prefix, name: (prefix, name))
    shipped = TypeSource("shipped", FINGERPRINTS, SERVICES)
    registry = Registry([shipped], _Supply)
    assert registry.message_class("Bump") == ("lcmtools.types", "my_msgs/Bump")
    assert registry.message_class("geometry_msgs/Twist") == ("shipped", "geometry_msgs/Twist")
    assert registry.service_class("Go") == ("lcmtools.types", "my_srvs/Go")
    assert registry.service_class("Trigger") == ("shipped", "std_srvs/Trigger")
    assert registry.candidates(7) == ["my_msgs/Bump"]
    with pytest.raises(AssertionError):
        registry.message_class("my_msgs/Nothing")


def test_looking_up_names_and_fingerprints_imports_no_type():
    script = (
        "import sys; from lcmtools.messages.registry import candidates, type_names\n"
        "assert candidates(0x2e7c07d7cdf7e027) and type_names()\n"
        "print([m for m in sys.modules if m.startswith('lcmtools.types.')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "['lcmtools.types.fingerprints']\n"


def test_a_type_that_several_sources_have_is_proposed_once():
    assert near_miss("acme/cmd", ["cmd_t", "cmd_t"]) == "did you mean cmd_t?"
