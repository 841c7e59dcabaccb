"""The user's settings: the table of all settings, and the settings file.

A setting's value comes from a flag, else from an environment variable, else from the file
``$XDG_CONFIG_HOME/lcmtools/config.yaml``. Commands and nodes read settings here. Must not know
buses, and prints nothing.
"""

import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from lcmtools.errors import InvalidFile, LcmtoolsError, UsageError
from lcmtools.folders import home_folder, read_text
from lcmtools.names import check_legal, did_you_mean

if TYPE_CHECKING:
    from lcmtools.formats.strict_yaml import YamlNode

COLORS = ("auto", "always", "never")

_DURATION = re.compile(r"(\d+\.?\d*|\.\d+)(ms|s|m|h)?", re.ASCII)
_BYTES = re.compile(r"(\d+\.?\d*|\.\d+)\s*(?:([kKMGT])(i)?)?B?", re.ASCII)
_SECONDS: Mapping[str, float] = {"ms": 0.001, "s": 1.0, "m": 60.0, "h": 3600.0}
_MOST_BYTES = 100_000  # the largest settings file


def parse_duration(text: str) -> float:
    """Parse a duration [s]: ``2``, ``500ms``, ``1m`` or ``1h``; UsageError for other text."""
    form = _DURATION.fullmatch(text)
    if not form:
        raise UsageError(f"'{text}' is not a duration", "write 500ms, 2s or 1m")
    return float(form[1]) * _SECONDS[form[2] or "s"]


def parse_bytes(text: str) -> int:
    """Parse a size [byte]: ``500MB``, ``1.5 GiB`` or ``1000``; UsageError for other text."""
    form = _BYTES.fullmatch(text)
    if not form or not float(form[1]):
        raise UsageError(f"'{text}' is not a size", "write 500MB or 1GB")
    base = 1024 if form[3] else 1000
    factor: int = base ** " kmgt".index((form[2] or " ").lower())
    return round(float(form[1]) * factor)


def _check_color(text: str) -> None:
    if text not in COLORS:
        raise UsageError(f"'{text}' is not one of auto, always, never", did_you_mean(text, COLORS))


class Setting(NamedTuple):
    """A setting: its key in the file, its environment variable, its flag and its default."""

    name: str
    variable: str
    option: str
    default: str = ""
    check: Callable[[str], object] = str  # raises LcmtoolsError for an invalid value


SETTINGS = {
    setting.name: setting
    for setting in (
        Setting("lcm_url", "LCM_DEFAULT_URL", "--lcm-url", "udpm://239.255.76.67:7667?ttl=0"),
        Setting("domain", "LCMTOOLS_DOMAIN", "--domain", "0"),
        Setting("namespace", "LCMTOOLS_NAMESPACE", "__ns:=", "/", check_legal),
        Setting("color", "LCMTOOLS_COLOR", "--color", "auto", _check_color),
        Setting("timeout", "LCMTOOLS_TIMEOUT", "--timeout", "", parse_duration),
    )
}

VARIABLES: Mapping[str, str] = {
    "LCMTOOLS_PACKAGE_PATH": "workspaces, in place of those that pkg create has noted",
    "ROS_PACKAGE_PATH": "folders with packages of ROS, each with a package.xml",
    "LCMTOOLS_TYPE_PATH": "folders with .lcm files",
    "LCMTOOLS_ENGINE": "the simulator's engine: bullet or mujoco",
    "LCMTOOLS_DEBUG": "1: errors with tracebacks",
    "NO_COLOR": "1: as --color=never",
    "FORCE_COLOR": "1: as --color=always",
    "CLICOLOR_FORCE": "1: as --color=always",
    "GAZEBO_MODEL_PATH": "folders of models for the simulator",
    "GZ_SIM_RESOURCE_PATH": "folders of models for the simulator",
    "IGN_GAZEBO_RESOURCE_PATH": "folders of models for the simulator",
}
"""The other environment variables, except those of the system such as HOME, with their meaning."""


class UserFile(NamedTuple):
    """The content of the user's settings file."""

    path: Path | None = None  # None if the environment has no home
    values: Mapping[str, str] = MappingProxyType({})  # setting to text
    lines: Mapping[str, int] = MappingProxyType({})  # setting to line, from 1
    problem: str = ""  # the reason why it is not known whether there is one

    def source(self, name: str) -> str:
        """Return a setting's file and line: "/home/me/.config/.../config.yaml:3"."""
        return f"{self.path}:{self.lines[name]}"


NO_FILE = UserFile()


class SettingValue(NamedTuple):
    """A setting's value and its source: an option, a variable, a line of the file, "default"."""

    value: str
    source: str


def user_path(environment: Mapping[str, str]) -> Path | None:
    """Return the path of the settings file; None if the environment has no home."""
    folder = home_folder(environment, "XDG_CONFIG_HOME", ".config")
    return folder / "lcmtools" / "config.yaml" if folder else None


def read_user_file(environment: Mapping[str, str]) -> UserFile:
    """Read the settings file, empty if there is none, or if its folder cannot be read.

    Raises:
        InvalidFile: It is invalid; the error has the line.
    """
    path = user_path(environment)
    if path is None:
        return NO_FILE
    try:
        state = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return UserFile(path)
    except (
        OSError
    ) as error:  # a home of another user, as sudo -E gives it: it has no settings of ours
        return UserFile(path, problem=f"cannot look into {path.parent}: {error.strerror}")
    return _read(path, state.st_mtime_ns, state.st_size)


def lookup(
    name: str, flag: str | None, environment: Mapping[str, str], file: UserFile
) -> SettingValue:
    """Return a setting's value from the flag, the variable, the file or the default, in this order.

    As in liblcm, an empty flag or variable counts as not given.
    """
    setting = SETTINGS[name]
    if flag:
        return SettingValue(flag, setting.option)
    if inherited := environment.get(setting.variable):
        return SettingValue(inherited, setting.variable)
    if name in file.values:
        return SettingValue(file.values[name], file.source(name))
    return SettingValue(setting.default, "default")


def usual_namespace(environment: Mapping[str, str]) -> str:
    """Return the namespace that names are resolved in by default; InvalidFile for a bad file."""
    return lookup("namespace", None, environment, read_user_file(environment)).value


@lru_cache(maxsize=4)
def _read(path: Path, modified: int, size: int) -> UserFile:
    """Parse the file, once per version of it: a long-running program may read it often."""
    del modified
    from lcmtools.formats.strict_yaml import read_file  # late: few users have a settings file

    if size > _MOST_BYTES:
        raise InvalidFile(f"{path}: {size} bytes are too many for a settings file")
    root = read_file(read_text(path, _MOST_BYTES), str(path))
    nodes = root.value if root else {}
    if not isinstance(nodes, dict):
        line = root.line if root else 1
        raise InvalidFile(f"{path}:{line}: expected settings with their values", _EXAMPLE)
    values = {name: _text(path, name, node) for name, node in nodes.items()}
    lines = {name: node.key_line for name, node in nodes.items()}
    return UserFile(path, {name: text for name, text in values.items() if text}, lines)


def _text(path: Path, name: str, node: "YamlNode") -> str:
    """Return a setting's text, checked by the setting's own rule instead of YAML's types."""
    where = f"{path}:{node.key_line}"
    if name not in SETTINGS:
        hint = did_you_mean(name, SETTINGS) or f"there are {', '.join(SETTINGS)}"
        raise InvalidFile(f"{where}: there is no setting '{name}'", hint)
    if not isinstance(node.value, str):
        raise InvalidFile(f"{where}: {name}: expected one value", _EXAMPLE)
    text = "" if node.is_nothing else node.value
    try:
        if text:
            SETTINGS[name].check(text)
    except LcmtoolsError as error:
        raise InvalidFile(f"{where}: {name}: {error.what}", error.hint) from error
    return text


_EXAMPLE = "write lines as  domain: 3"
