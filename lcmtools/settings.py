"""What is usual for a person: the settings file, and the table of all settings.

A setting is said by a flag, else by an environment variable, else in the user's file
``$XDG_CONFIG_HOME/lcmtools/config.yaml``; this module reads the file, strictly, and says which of
the three counts. Commands and nodes both ask here. It knows no bus and prints nothing.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.errors import InvalidFile, LcmtoolsError, UsageError
from lcmtools.names import check_legal, did_you_mean

if TYPE_CHECKING:  # yaml takes a moment to load, and most people have no settings file
    import yaml

COLORS = ("auto", "always", "never")

_DURATION = re.compile(r"(\d+\.?\d*|\.\d+)(ms|s|m)?", re.ASCII)
_SECONDS: Mapping[str, float] = {"ms": 0.001, "s": 1.0, "m": 60.0}
_MOST_BYTES = 100_000  # of a settings file; whatever is longer is something else


def parse_duration(text: str) -> float:
    """A time span in seconds: ``2``, ``2s``, ``500ms`` or ``1m``.

    Raises:
        UsageError: It is something else.
    """
    form = _DURATION.fullmatch(text)
    if not form:
        raise UsageError(f"'{text}' is not a duration", "write 500ms, 2s or 1m")
    return float(form[1]) * _SECONDS[form[2] or "s"]


def _check_color(text: str) -> None:
    if text not in COLORS:
        raise UsageError(f"'{text}' is not one of auto, always, never", did_you_mean(text, COLORS))


@dataclass(frozen=True, slots=True)
class Setting:
    """Something that can be said for good.

    Attributes:
        name: Its key in the file.
        variable: Its environment variable.
        option: Its flag.
        default: What counts where nothing is said; "" for nothing.
        check: Raises LcmtoolsError for a value that is wrong.
    """

    name: str
    variable: str
    option: str
    default: str = ""
    check: Callable[[str], object] = str


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


@dataclass(frozen=True, slots=True)
class UserFile:
    """What the user's file says.

    Attributes:
        path: Where it is; None where the environment names no home.
        values: By the settings' names, as text.
        lines: The line of each value, from 1 on.
    """

    path: Path | None = None
    values: Mapping[str, str] = field(default_factory=dict)
    lines: Mapping[str, int] = field(default_factory=dict)

    def source(self, name: str) -> str:
        """Where a value is written, for messages: "/home/me/.config/.../config.yaml:3"."""
        return f"{self.path}:{self.lines[name]}"


NO_FILE = UserFile()


@dataclass(frozen=True, slots=True)
class Said:
    """A setting's value, and what says so: an option, a variable, a place in the file."""

    value: str
    source: str


def user_path(environment: Mapping[str, str]) -> Path | None:
    """Where the user's file is, by the XDG rules; None where there is no home."""
    folder = environment.get("XDG_CONFIG_HOME", "")
    if folder.startswith("/"):  # the XDG rules have a relative one ignored
        return Path(folder) / "lcmtools" / "config.yaml"
    home = environment.get("HOME", "")
    return Path(home) / ".config" / "lcmtools" / "config.yaml" if home else None


def read_user_file(environment: Mapping[str, str]) -> UserFile:
    """What the user's file says; nothing where there is none.

    Raises:
        InvalidFile: It cannot be read or is wrong, with the line.
    """
    path = user_path(environment)
    if path is None:
        return NO_FILE
    try:
        state = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return UserFile(path)
    except OSError as error:
        raise InvalidFile(f"cannot read {path}: {error.strerror}") from error
    return _read(path, state.st_mtime_ns, state.st_size)


def said(name: str, flag: str | None, environment: Mapping[str, str], file: UserFile) -> Said:
    """A setting's value: the flag's, else the variable's, else the file's, else the default.

    An empty flag or variable counts as not given, as in liblcm.
    """
    setting = SETTINGS[name]
    if flag:
        return Said(flag, setting.option)
    if inherited := environment.get(setting.variable):
        return Said(inherited, setting.variable)
    if name in file.values:
        return Said(file.values[name], file.source(name))
    return Said(setting.default, "default")


def usual_namespace(environment: Mapping[str, str]) -> str:
    """The namespace that names are resolved in where nothing else is said.

    Raises:
        InvalidFile: The user's file is wrong.
    """
    return said("namespace", None, environment, read_user_file(environment)).value


@lru_cache(maxsize=4)
def _read(path: Path, modified: int, size: int) -> UserFile:
    """The file in the state that it was seen in: a program that runs long may ask often."""
    del modified
    import yaml

    try:
        if size > _MOST_BYTES:
            raise InvalidFile(f"{path}: {size} bytes are no settings file")
        root = yaml.compose(path.read_text("utf-8"), Loader=yaml.SafeLoader)
    except OSError as error:
        raise InvalidFile(f"cannot read {path}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise InvalidFile(f"{path}{_where(error)}: this is not YAML", _EXAMPLE) from error
    entries = [] if root is None or _is_nothing(root) else list(_entries(path, root))
    return UserFile(
        path,
        {name: text for name, text, _ in entries if text},
        {name: line for name, _, line in entries},
    )


def _entries(path: Path, root: "yaml.Node") -> Iterator[tuple[str, str, int]]:
    """Each setting with its text and line, checked."""
    import yaml

    if not isinstance(root, yaml.MappingNode):
        raise InvalidFile(f"{path}: expected settings with their values", _EXAMPLE)
    known: set[str] = set()
    for key, value in root.value:
        line = key.start_mark.line + 1
        name = str(key.value) if isinstance(key, yaml.ScalarNode) else ""
        if name not in SETTINGS:
            hint = did_you_mean(name, SETTINGS) or f"there are {', '.join(SETTINGS)}"
            raise InvalidFile(f"{path}:{line}: there is no setting '{name}'", hint)
        if name in known:
            raise InvalidFile(f"{path}:{line}: '{name}' is given twice", "leave one of them out")
        if not isinstance(value, yaml.ScalarNode):
            raise InvalidFile(f"{path}:{line}: {name}: expected one value", _EXAMPLE)
        known.add(name)
        # the text as written: a setting's own type decides how it is read, not YAML's
        text = "" if _is_nothing(value) else str(value.value)
        _check(f"{path}:{line}", name, text)
        yield name, text, line


def _is_nothing(node: "yaml.Node") -> bool:
    return str(node.tag).endswith(":null")


def _check(where: str, name: str, text: str) -> None:
    if not text:
        return
    try:
        SETTINGS[name].check(text)
    except LcmtoolsError as error:
        raise InvalidFile(f"{where}: {name}: {error.what}", error.hint) from error


def _where(error: Exception) -> str:
    """The line of a mistake in YAML, as ":3"."""
    mark = getattr(error, "problem_mark", None)
    return f":{mark.line + 1}" if mark else ""


_EXAMPLE = "write lines as  domain: 3"
