"""Installing completion where a shell looks for it.

A second installation changes nothing. A line is added to a shell's own settings only where the
shell would not find the script otherwise, and only once.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from shlex import quote

from lcmtools.errors import LcmtoolsError, UsageError, os_errors_as
from lcmtools.folders import home_folder, write_atomically

NAMES = ("bash", "zsh", "fish")
_ALONE = "the script alone: lcmtools completion bash"
_MARK = "# lcmtools: completion"
_BASH_COMPLETION = ("usr/share/bash-completion/bash_completion", "etc/bash_completion")


@dataclass(frozen=True, slots=True)
class Installation:
    """The parts of an installation."""

    script: Path  # the file that the script goes to
    settings: Path | None  # the shell's settings, where they need a line; None for none
    line: str
    restart: str  # the command that brings it into the shell that runs already


def script(shell: str) -> str:
    """Return the script that makes a shell complete."""
    folder = files("lcmtools.cli.completion") / "scripts"
    return folder.joinpath(f"lcmtools.{shell}").read_text(encoding="utf-8")


def shell_named(name: str | None, environment: Mapping[str, str]) -> str:
    """Return the named shell, or else the user's login shell."""
    meant = name or Path(environment.get("SHELL", "")).name
    if meant not in NAMES:
        what = f"there is no completion for {meant}" if meant else "SHELL does not name a shell"
        raise UsageError(what, f"write one of {', '.join(NAMES)}")
    return meant


def plan(shell: str, environment: Mapping[str, str], root: Path = Path("/")) -> Installation:
    """Return the parts of an installation for "bash", "zsh" or "fish".

    ``root`` is the folder of the system's own files.
    """
    data = home_folder(environment, "XDG_DATA_HOME", ".local/share")
    config = home_folder(environment, "XDG_CONFIG_HOME", ".config")
    home = home_folder(environment, "", "")
    if data is None or config is None or home is None:
        raise LcmtoolsError("HOME is not set", _ALONE)
    if shell == "fish":
        return Installation(config / "fish/completions/lcmtools.fish", None, "", "exec fish")
    if shell == "zsh":
        target = data / "zsh/site-functions/_lcmtools"
        file, named = quote(str(target)), environment.get("ZDOTDIR", "")
        # the user may not have loaded zsh's completion system
        load = "(( $+functions[compdef] )) || { autoload -Uz compinit && compinit }"
        settings = (Path(named) if named.startswith("/") else home) / ".zshrc"
        line = f"[[ -r {file} ]] && {{ {load}; . {file} }}  {_MARK}"
        return Installation(target, settings, line, "exec zsh")
    target = data / "bash-completion/completions/lcmtools"
    rows = (_text(home / ".bashrc") or "").splitlines()
    is_loaded = any((root / name).exists() for name in _BASH_COMPLETION) and any(
        "bash_completion" in row and not row.lstrip().startswith("#") for row in rows
    )
    file = quote(str(target))
    line = f"[ -r {file} ] && . {file}  {_MARK}"
    return Installation(target, None if is_loaded else home / ".bashrc", line, "exec bash")


def install(shell: str, wanted: Installation) -> Iterator[str]:
    """Install a shell's script; yield a line for each step."""
    text = script(shell)
    if _text(wanted.script) == text:
        yield f"{wanted.script} already exists"
    else:
        _write(wanted.script, text)
        yield f"wrote {wanted.script}"
    if wanted.settings is None:
        return
    before = _text(wanted.settings) or ""
    if wanted.line in before.splitlines():
        yield f"{wanted.settings} already has the line for it"
        return
    kept = _without_ours(before)
    gap = "" if not kept or kept.endswith("\n") else "\n"
    _write(wanted.settings, f"{kept}{gap}{wanted.line}\n")
    yield f"added a line to {wanted.settings}: {wanted.line}"


def uninstall(wanted: Installation) -> Iterator[str]:
    """Undo ``install``; yield a line for each step."""
    if _text(wanted.script) is None:
        yield f"{wanted.script} is not there"
    else:
        with os_errors_as(f"cannot remove {wanted.script}"):
            wanted.script.unlink()
        yield f"removed {wanted.script}"
    before = (_text(wanted.settings) if wanted.settings else None) or ""
    kept = _without_ours(before)
    if wanted.settings and kept != before:
        _write(wanted.settings, kept)
        yield f"removed the line from {wanted.settings}"


def _without_ours(text: str) -> str:
    rows = text.splitlines(keepends=True)
    return "".join(row for row in rows if not row.rstrip("\n").endswith(_MARK))


def _text(path: Path) -> str | None:
    with os_errors_as(f"cannot read {path}"), suppress(FileNotFoundError, NotADirectoryError):
        return path.read_bytes().decode("utf-8", "surrogateescape")
    return None


def _write(path: Path, text: str) -> None:
    with os_errors_as(f"cannot write {path}", _ALONE):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, text)
