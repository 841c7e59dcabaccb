"""Creating a package: the files of one that runs, has tests and can be installed.

Belongs here: checking its names, filling in the templates in the folder ``template``, and writing
either all files or none. Must not know the command line.
"""

import keyword
import re
import shutil
import sys
import tempfile
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

from lcmtools.errors import InvalidName, LcmtoolsError, UsageError, os_errors_as
from lcmtools.names import did_you_mean
from lcmtools.packages.cpp_nodes import PROJECT

TEMPLATES = Path(__file__).parent / "template"

_PACKAGE = re.compile(r"[a-z][a-z0-9_]*", re.ASCII)
_MESSAGE = re.compile(r"[A-Z][A-Za-z0-9]*", re.ASCII)
_LONGEST = 50
_TAKEN = ("lcm", "lcmtools", "lcmtools_sim", "test", "tests")
_FILES = {
    "pyproject.toml": "pyproject.toml",
    "README.md": "README.md",
    "gitignore": ".gitignore",
    "package.py": "{package}/__init__.py",
    "node.py": "{package}/{node}.py",
    "launch.yaml": "launch/{node}.yaml",
    "test_node.py": "tests/test_{node}.py",
}
_CPP_FILES = {
    "pyproject_cpp.toml": "pyproject.toml",
    "README_cpp.md": "README.md",
    "gitignore": ".gitignore",
    "CMakeLists.txt": "CMakeLists.txt",
    "node.cpp": "src/{node}.cpp",
    "launch.yaml": "launch/{node}.yaml",
}
_MESSAGE_FILES = {
    "msg.py": "{package}/msg/__init__.py",
    "message.lcm": "{package}/msg/{message}.lcm",
}
_CPP_MESSAGE_FILES = {"message.lcm": "msg/{message}.lcm"}
_USUAL_TOPICS = {
    "geometry_msgs": ("Twist", "cmd_vel"),
    "nav_msgs": ("Odometry", "odometry"),
    "sensor_msgs": ("LaserScan", "scan"),
    "std_msgs": ("String", "chatter"),
}
"""The topic that a new node subscribes to, by the message package that it depends on."""


@dataclass(frozen=True, slots=True)
class NewPackage:
    """The description of a package to create."""

    name: str  # as Python imports it
    node: str  # its node's name
    message: str = ""  # its message's name; "" for none
    dependencies: Sequence[str] = ()  # packages of message types that it uses
    license: str = ""  # an SPDX name ("MIT"); "" for none
    is_cpp: bool = False  # the node is in C++


def check(new: NewPackage, known: Collection[str]) -> None:
    """Refuse names that Python, LCM or lcmtools could not use.

    ``known`` are the existing packages of message types.

    Raises:
        InvalidName: A name breaks a rule.
        UsageError: A dependency is not known, or the licence is not a short name.
    """
    _check_module(new.name, "package")
    check_node_name(new.node)
    if new.name in sys.stdlib_module_names or new.name in _TAKEN:
        raise InvalidName(f"'{new.name}' is the name of another Python package", "use another one")
    if new.message and not _MESSAGE.fullmatch(new.message):
        raise InvalidName(
            f"'{new.message}' is not a valid message name",
            "it starts with a capital letter: letters and digits, as in ControllerEvaluationStat",
        )
    if keyword.iskeyword(new.message):
        raise InvalidName(f"'{new.message}' is a keyword of Python", "use another name")
    for name in new.dependencies:
        if name not in known and name != new.name:
            hint = did_you_mean(name, known) or "lcmtools msg packages lists them"
            raise UsageError(f"--deps: there is no package '{name}' of message types", hint)
    if not all(one.isalnum() or one in "-.+ ()" for one in new.license):
        what = f"--license: '{new.license}' is not the short name of a licence"
        raise UsageError(what, "for example MIT")


def create(new: NewPackage, folder: Path, *, replace: bool = False) -> list[Path]:
    """Write a checked package into its folder; return the written files, relative to it.

    With ``replace``, existing files of the same names are overwritten.

    Raises:
        LcmtoolsError: A file already exists, or cannot be written.
    """
    texts = _texts(new)
    with os_errors_as(f"cannot write {folder}"):
        present = [path for path in texts if (folder / path).exists()]
        if present and not replace:
            raise LcmtoolsError(
                f"{folder / present[0]} already exists", "--force overwrites existing files"
            )
        _write(texts, folder)
        (folder / "src").mkdir(exist_ok=True)  # for sources in C++, which may be added later
    return sorted(texts)


def check_node_name(name: str) -> None:
    """Raise InvalidName for a name that a node's file cannot have."""
    _check_module(name, "node")
    if name == "msg":  # reserved for the folder of the package's messages
        raise InvalidName(f"a node cannot be called '{name}'", "use another name")


def node_text(new: NewPackage) -> str:
    """Return the text of a node's file."""
    return _filled("node.cpp" if new.is_cpp else "node.py", _words(new))


def cmake_text(package: str) -> str:
    """Return the text of a CMakeLists.txt without a node."""
    return _filled("CMakeLists.txt", {"package": package})


def cmake_entry(node: str, source: str, types: Sequence[str]) -> str:
    """Return the lines of a CMakeLists.txt that declare a node with the types that it includes."""
    words = {"node": node, "source": source, "generated": " ".join(types)}
    return _filled("cmake_node", words)


def _check_module(name: str, kind: str) -> None:
    if not _PACKAGE.fullmatch(name) or len(name) > _LONGEST:
        raise InvalidName(
            f"'{name}' is not a {kind}'s name",
            "it starts with a small letter: small letters, digits and '_', as in air_lab0",
        )
    if keyword.iskeyword(name):
        raise InvalidName(f"'{name}' is a keyword of Python", "use another name")


def _write(texts: Mapping[Path, str], folder: Path) -> None:
    """Write into a temporary folder, then move: a full disk leaves no partial package."""
    made = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix=".making-", dir=folder))
    try:
        for path, text in texts.items():
            (scratch / path).parent.mkdir(parents=True, exist_ok=True)
            (scratch / path).write_text(text, "utf-8")
        for path in texts:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (scratch / path).replace(folder / path)
    except OSError:
        if made:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _texts(new: NewPackage) -> dict[Path, str]:
    usual, with_message = (
        (_CPP_FILES, _CPP_MESSAGE_FILES) if new.is_cpp else (_FILES, _MESSAGE_FILES)
    )
    files = usual | (with_message if new.message else {})
    words = _words(new)
    texts = {
        Path(target.format_map(words)): _filled(source, words) for source, target in files.items()
    }
    if new.is_cpp:
        entry = cmake_entry(new.node, f"src/{new.node}.cpp", words["generated"].split())
        texts[Path(PROJECT)] += entry
    return texts


def _filled(template: str, words: Mapping[str, str]) -> str:
    return Template((TEMPLATES / f"{template}.txt").read_text("utf-8")).substitute(words)


def _words(new: NewPackage) -> dict[str, str]:
    """Return the values of the templates' placeholders."""
    heard = next((one for one in new.dependencies if one in _USUAL_TOPICS), "std_msgs")
    kind, topic = _USUAL_TOPICS[heard]
    own_import = f'{new.message} = lcmtools.message_class("{new.name}/{new.message}")\n'
    sent = new.message or "Int32"
    return {
        "package": new.name,
        "node": new.node,
        "node_class": "".join(part.capitalize() for part in new.node.split("_")),
        "message": new.message,
        "dependencies": ", ".join(f'"{one}"' for one in new.dependencies),
        "license": f'license = "{new.license}"\n' if new.license else "",
        "heard_package": heard,
        "heard": kind,
        "topic": topic,
        "sent": sent,
        "sent_type": f"{new.name}/{new.message}" if new.message else "std_msgs/Int32",
        "sent_class": f"{new.name}::{new.message}" if new.message else "std_msgs::Int32",
        "generated": " ".join(
            dict.fromkeys([heard, f"{new.name}/{new.message}" if new.message else "std_msgs"])
        ),
        "sent_field": "count" if new.message else "data",
        "own_import": f"\n{own_import}" if new.message else "",
        "other_import": "" if new.message else "from lcmtools.types.std_msgs import Int32\n",
        "message_entry": (
            f'\n[project.entry-points."lcmtools.messages"]\n{new.name} = "{new.name}.msg"\n'
            if new.message
            else ""
        ),
    }
