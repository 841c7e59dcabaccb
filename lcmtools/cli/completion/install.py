"""Installing completion where a shell looks for it.

A second installation changes nothing. A line is added to a shell's own settings only where the
shell would not find the script otherwise, and only once.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from shlex import quote

from lcmtools.cli.files import home_folder, write_atomically
from lcmtools.errors import LcmtoolsError, UsageError

NAMES = ("bash", "zsh", "fish")
_MARK = "# lcmtools: completion"
_BASH_COMPLETION = ("usr/share/bash-completion/bash_completion", "etc/bash_completion")


@dataclass(frozen=True, slots=True)
class Plan:
    """The parts of an installation.

    Attributes:
        script: The file that the script goes to.
        settings: The shell's settings, where a line has to be in them; None for none.
        line: The line.
        restart: The command that brings it into the shell that runs already.
    """

    script: Path
    settings: Path | None
    line: str
    restart: str


def script(shell: str) -> str:
    """Return the script that makes a shell complete."""
    folder = files("lcmtools.cli.completion") / "scripts"
    return folder.joinpath(f"lcmtools.{shell}").read_text(encoding="utf-8")


def shell_named(name: str | None, environment: Mapping[str, str]) -> str:
    """Return the shell that is named, else the user's own.

    Raises:
        UsageError: There is no completion for it.
    """
    own = Path(environment.get("SHELL", "")).name
    meant = name or own
    if meant not in NAMES:
        what = f"there is no completion for {meant}" if meant else "SHELL does not say which shell"
        raise UsageError(what, f"write one of {', '.join(NAMES)}")
    return meant


def plan(shell: str, environment: Mapping[str, str], root: Path = Path("/")) -> Plan:
    """Return the parts of an installation for "bash", "zsh" or "fish".

    ``root`` is the folder of the system's own files.

    Raises:
        LcmtoolsError: The environment names no home.
    """
    data = home_folder(environment, "XDG_DATA_HOME", ".local/share")
    config = home_folder(environment, "XDG_CONFIG_HOME", ".config")
    home = home_folder(environment, "", "")
    if data is None or config is None or home is None:
        raise LcmtoolsError("HOME is not set", "the script alone: lcmtools completion bash")
    if shell == "fish":
        return Plan(config / "fish/completions/lcmtools.fish", None, "", "exec fish")
    if shell == "zsh":
        target = data / "zsh/site-functions/_lcmtools"
        settings = _zsh_folder(environment, home) / ".zshrc"
        return Plan(target, settings, _zsh_line(target), "exec zsh")
    target = data / "bash-completion/completions/lcmtools"
    loads = any((root / name).exists() for name in _BASH_COMPLETION)
    is_loaded = loads and _mentions(home / ".bashrc", "bash_completion")
    file = quote(str(target))
    line = f"[ -r {file} ] && . {file}  {_MARK}"
    return Plan(target, None if is_loaded else home / ".bashrc", line, "exec bash")


def install(shell: str, wanted: Plan) -> Iterator[str]:
    """Install a shell's script; yield a line for each step.

    Raises:
        LcmtoolsError: A file cannot be written.
    """
    text = script(shell)
    if _text(wanted.script) == text:
        yield f"{wanted.script} is there already"
    else:
        _write(wanted.script, text)
        yield f"wrote {wanted.script}"
    if wanted.settings is None:
        return
    before = _text(wanted.settings) or ""
    if wanted.line in before.splitlines():
        yield f"{wanted.settings} has the line for it already"
        return
    kept = "".join(_without_ours(before))
    gap = "" if not kept or kept.endswith("\n") else "\n"
    _write(wanted.settings, f"{kept}{gap}{wanted.line}\n")
    yield f"added a line to {wanted.settings}: {wanted.line}"


def uninstall(wanted: Plan) -> Iterator[str]:
    """Undo ``install``; yield a line for each step.

    Raises:
        LcmtoolsError: A file cannot be changed.
    """
    if _text(wanted.script) is None:
        yield f"{wanted.script} is not there"
    else:
        try:
            wanted.script.unlink()
        except OSError as error:
            raise LcmtoolsError(f"cannot remove {wanted.script}: {error.strerror}") from error
        yield f"removed {wanted.script}"
    before = _text(wanted.settings) if wanted.settings else None
    if wanted.settings and before is not None:
        kept = "".join(_without_ours(before))
        if kept != before:
            _write(wanted.settings, kept)
            yield f"removed the line from {wanted.settings}"


def _zsh_folder(environment: Mapping[str, str], home: Path) -> Path:
    named = environment.get("ZDOTDIR", "")
    return Path(named) if named.startswith("/") else home


def _zsh_line(target: Path) -> str:
    """A line that loads zsh's completion system too where the user has not."""
    load = "(( $+functions[compdef] )) || { autoload -Uz compinit && compinit }"
    file = quote(str(target))
    return f"[[ -r {file} ]] && {{ {load}; . {file} }}  {_MARK}"


def _mentions(path: Path, word: str) -> bool:
    """True if a file has a line with a word that is no comment."""
    lines = (_text(path) or "").splitlines()
    return any(word in line and not line.lstrip().startswith("#") for line in lines)


def _without_ours(text: str) -> list[str]:
    """The lines but for that of an earlier installation."""
    lines = text.splitlines(keepends=True)
    return [line for line in lines if not line.rstrip("\n").endswith(_MARK)]


def _text(path: Path) -> str | None:
    """The text of a file; None where there is none.

    Raises:
        LcmtoolsError: It is there and cannot be read.
    """
    try:
        return path.read_bytes().decode("utf-8", "surrogateescape")
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise LcmtoolsError(f"cannot read {path}: {error.strerror}") from error


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, text)
    except OSError as error:
        what = f"cannot write {path}: {error.strerror}"
        raise LcmtoolsError(what, "the script alone: lcmtools completion bash") from error
