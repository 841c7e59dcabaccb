"""Modules of types for nodes that lcmtools runs: ``from rover.msg import Status``."""

import importlib
import sys

import pytest

from lcmtools import message_class
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import service_class
from lcmtools.messages.supply import set_supply
from lcmtools.packages import provide_user_types
from lcmtools.packages.ros_modules import _TypePackages, provide_type_modules

FILES = {
    "types/a.lcm": "// package no;\npackage rover; struct Status { double volts; }",
    "types/b.lcm": "package rover;struct Go_Request { int8_t x; } struct Go_Response { int8_t x; }",
    "types/deep/c.lcm": "package fleet.arm; struct pose_t { double x; }",
    "types/lambda.lcm": "package lambda; struct Pose { double x; }",
    "types/survey/package.xml": "<package><name>survey</name></package>",
    "types/survey/msg/Progress.msg": "float64 x",
    "types/survey/srv/Goto.srv": "float64 x\n---\nbool ok",
    "types/wrong.lcm": "package wrong; struct Wrong { double x }",
    "types/real.lcm": "package real; struct Real { double x; }",
    "types/gear.lcm": "package rover;enum Gear { LOW = 0, HIGH = 3 }",
    "types/bare.lcm": "package bare; struct Bare { double x; }",
    "code/real/__init__.py": "own = 1",
    "code/real/msg.py": "own = 2",
    "code/bare/__init__.py": "own = 3",
    "code/mixed/msg/code.py": "own = 4",
    "types/mixed.lcm": "package mixed; struct Mixed { double x; }",
    "code/lab.dist-info/METADATA": "Name: lab\nVersion: 1\n",
    "code/lab.dist-info/entry_points.txt": "[lcmtools.messages]\nlab = lab\nlost = lost.msg\n",
    "code/lab/__init__.py": "own = 5",
    "code/lab/msg/Stat.msg": "float64 x",
    "code/lab/more.lcm": "package lab_types; struct More { double x; }",
}

MODULES = {"rover", "fleet", "lambda_", "survey", "wrong", "real", "bare", "mixed", "nav_msgs"}
MODULES |= {"lab", "lab_types"}


@pytest.fixture(autouse=True)
def _modules(write, cache_folder, monkeypatch):
    """Provide the modules of the types on LCMTOOLS_TYPE_PATH, and Python packages beside them."""
    root = write(FILES)
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_folder))
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(root / "types"))
    others = [one for one in sys.meta_path if type(one).__module__ != _TypePackages.__module__]
    monkeypatch.setattr(sys, "meta_path", others)
    monkeypatch.syspath_prepend(str(root / "code"))
    provide_user_types()
    provide_type_modules(root / "code")
    yield
    set_supply(None)
    for name in list(sys.modules):
        if name.partition(".")[0] in MODULES:
            del sys.modules[name]


@pytest.mark.parametrize(
    ("statement", "name", "kind"),
    [
        ("import rover.msg", "rover.msg.Status", "rover/Status"),
        ("from rover.msg import Status", "Status", "rover/Status"),
        ("from rover import Status", "Status", "rover/Status"),
        ("import rover", "rover.Status", "rover/Status"),
        ("from rover import msg", "msg.Status", "rover/Status"),
        ("from rover.msg import *", "Status", "rover/Status"),
        ("from rover.srv import Go", "Go.Request", "rover/Go_Request"),
        ("from fleet.arm import pose_t", "pose_t", "fleet.arm/pose_t"),
        ("import fleet.arm.msg", "fleet.arm.msg.pose_t", "fleet.arm/pose_t"),
        ("from lambda_.msg import Pose", "Pose", "lambda/Pose"),
        ("from survey.msg import Progress", "Progress", "survey/Progress"),
        ("from survey.srv import Goto", "Goto.Response", "survey/Goto_Response"),
        ("from bare.msg import Bare", "Bare", "bare/Bare"),
        ("from mixed.msg import Mixed", "Mixed", "mixed/Mixed"),
        ("from nav_msgs.msg import Path", "Path", "nav_msgs/Path"),
        ("from nav_msgs import Path", "Path", "nav_msgs/Path"),
        ("from lab.msg import Stat", "Stat", "lab/Stat"),  # an installed package
        ("from lab_types import More", "More", "lab_types/More"),
    ],
)
def test_types_are_imported(statement, name, kind):
    assert _run(f"{statement}\nfound = {name}") is message_class(kind)


def test_an_enum_is_imported_with_its_values():
    assert _run("from rover.msg import Gear\nfound = Gear.HIGH + 1") == 4
    assert _run("from rover import Gear\nfound = Gear(3)") == "HIGH"
    assert _run("from rover.msg import *\nfound = Gear.LOW") == 0


def test_a_service_is_the_one_that_its_name_means():
    from rover.srv import Go

    assert Go is service_class("rover/Go")


@pytest.mark.parametrize(
    ("module", "value"),
    [("real", 1), ("real.msg", 2), ("bare", 3), ("mixed.msg.code", 4), ("lab", 5)],
)
def test_a_python_package_of_that_name_takes_precedence(module, value):
    assert importlib.import_module(module).own == value
    with pytest.raises(ImportError):
        _run("from real.msg import Real")


@pytest.mark.parametrize(
    ("statement", "said"),
    [
        (
            "from rover.msg import Stats",
            "cannot import name 'Stats' from 'rover.msg': did you mean",
        ),
        (
            "from rover.srv import Stop",
            "'rover.srv': it has Go_Request, Go_Response, Status, Go, Gear",
        ),
        ("from rover import Stats", "cannot import name 'Stats' from 'rover': did you mean Status"),
        ("import rover.stuff", "cannot import name 'stuff' from 'rover': it has msg, srv, Go_Req"),
        ("from fleet import hand", "cannot import name 'hand' from 'fleet': it has msg, srv"),
        ("from nav_msgs.msg import Twist", "from 'nav_msgs.msg': it has GridCells, MapMetaData, "),
        ("import no_such_package.msg", "No module named 'no_such_package'"),
    ],
)
def test_what_is_missing_is_named_with_what_is_there(statement, said):
    with pytest.raises(ImportError, match=said):
        _run(statement)


def test_a_wrong_file_is_named_when_its_type_is_imported():
    with pytest.raises(LcmtoolsError, match=r"wrong\.lcm:1: .*a ';' is missing"):
        _run("from wrong.msg import Wrong")


def test_no_type_file_is_read_for_other_modules(monkeypatch):
    monkeypatch.setattr("lcmtools.packages.user_types.read_folders", None)
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    assert importlib.import_module("colorsys")
    assert importlib.import_module("real.msg")
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("email.no_such_module")
    with pytest.raises(TypeError, match="not callable"):
        importlib.import_module("rover")


def _run(program):
    """Run a program; return its value ``found``."""
    values = {}
    exec(program, values)  # noqa: S102 - the test's own text
    return values.get("found")
