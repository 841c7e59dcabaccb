"""Building nodes in C++ with CMake: those of a package, or that of one source.

Belongs here: the headers' folder, liblcm and a compiler's flags, running CMake, and what is said if
a program is missing or a build fails. Must not know the command line.
"""

import contextlib
import fcntl
import hashlib
import os
import re
import shutil
import signal
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.folders import cache_folder
from lcmtools.messages.registry import packages
from lcmtools.packages.cpp_nodes import (
    PROJECT,
    cpp_sources,
    included,
    parts_of,
    source_text,
    wrong_include,
)
from lcmtools.packages.create import cmake_entry, cmake_text
from lcmtools.packages.programs import built_program
from lcmtools.packages.runnable_nodes import Runnable


@dataclass(frozen=True, slots=True)
class Liblcm:
    """An installed liblcm: its ``prefix`` is "" for that of the system, which pkg-config knows."""

    prefix: str
    flags: tuple[str, ...]  # of a compiler, to compile and link


def cpp_folder() -> Path:
    """Return the folder to include ``lcmtools/node.hpp`` from; CMake finds its package there."""
    package = Path(__file__).parents[1]
    installed = package / "cpp"
    return installed if installed.is_dir() else package.parent / "cpp"


def find_liblcm() -> Liblcm:
    """Return the system's liblcm, else the one that the Python package lcm brings.

    Raises:
        MissingExtra: There is none with headers.
    """
    flags = _pkg_config_flags("lcm")
    return Liblcm("", flags) if flags else Liblcm(str(prefix := wheel_prefix()), _flags_of(prefix))


def wheel_prefix() -> Path:
    """Return the folder with ``include/lcm`` and ``lib/liblcm.so`` of the Python package lcm.

    Raises:
        MissingExtra: It has none.
    """
    spec = find_spec("lcm")
    prefix = Path(spec.origin).parent.parent if spec and spec.origin else Path()
    if not (prefix / "include" / "lcm" / "lcm.h").is_file():
        hint = "type: sudo apt install liblcm-dev, or pip install lcm"
        raise MissingExtra("there is no liblcm with its C++ headers", hint)
    return prefix


def compiler_flags() -> list[str]:
    """Return the flags that compile and link a node: ``g++ node.cpp FLAGS``."""
    return ["-std=c++17", f"-I{cpp_folder()}", *find_liblcm().flags, "-pthread"]


def _flags_of(prefix: Path) -> tuple[str, ...]:
    library = prefix / "lib"
    return (f"-I{prefix / 'include'}", f"-L{library}", f"-Wl,-rpath,{library}", "-llcm")


def _pkg_config_flags(module: str) -> tuple[str, ...]:
    """Return the flags for an installed library; () if pkg-config does not know it."""
    import subprocess

    program = shutil.which("pkg-config")
    if program is None:
        return ()
    command = [program, "--cflags", "--libs", module]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - pkg-config
    return tuple(done.stdout.split()) if done.returncode == 0 else ()


_NEEDED = {"cmake": "cmake", "c++": "g++", "make": "make"}
"""The programs that building needs, and the packages of Debian and Ubuntu that have them."""
_OF = "source"  # the file with the path of the source that a folder of the cache is of
_ERRORS = (
    re.compile(r"CMake Error at (?:.*/)?([^/\n]+:\d+).*\n\s*(\S.*)"),
    re.compile(r"([^/\n]+:\d+):\d+: (?:fatal )?error: (.*)"),
    re.compile(r"(undefined reference to .*|cannot find -l.*)"),
)
"""Lines of CMake, of the compiler and of the linker: the place, and what is wrong there."""


def has_cpp(folder: Path) -> bool:
    """Return whether a package's folder has nodes in C++."""
    return (folder / PROJECT).is_file()


def build_cpp(folder: Path) -> None:
    """Configure and compile a package, in its folder build; what is printed goes to stderr.

    Raises:
        MissingExtra: There is no CMake, no compiler, or no liblcm.
        LcmtoolsError: CMake or the compiler fails.
    """
    _build(folder, folder.name)


@contextlib.contextmanager
def built_source(source: Path) -> Iterator[Path]:
    """Build the node of a source, and nothing else; yield its program. Nothing is printed.

    It is built in the package whose CMakeLists.txt declares it. If there is none, its package is in
    the user's cache, with the source's parts and the types that these include: the next time, only
    what has changed is compiled. While another process builds it, this one waits.

    Raises:
        MissingExtra: There is no CMake, no compiler, or no liblcm.
        LcmtoolsError: CMake or the compiler fails; the error has the first one of theirs.
    """
    source = source.resolve()
    for folder in source.parents:
        for node in (name for name, file in cpp_sources(folder).items() if file == source):
            _build(folder, source.name, node)
            yield built_program(Runnable(folder.name, node, "", folder))
            return
    with _folder_for(source) as own:
        parts = parts_of(source)
        types = included("\n".join(map(source_text, parts)), packages()) or ["std_msgs"]
        entry = cmake_entry("program", " ".join(f'"{one}"' for one in parts), types)
        text = cmake_text("program") + entry
        if source_text(own / PROJECT) != text:
            (own / PROJECT).write_text(text, "utf-8")
        with (own / _OF).open() as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            _build(own, source.name, "program")
            program = own / source.stem  # the name that the process has
            program.unlink(missing_ok=True)
            program.hardlink_to(own / "build" / "program")
        yield program


@contextlib.contextmanager
def _folder_for(source: Path) -> Iterator[Path]:
    """Yield a source's folder in the cache; a temporary one if the cache cannot be written."""
    key = hashlib.sha256(os.fsencode(f"{source} {sys.prefix}")).hexdigest()[:20]
    with contextlib.ExitStack() as owned:
        try:
            folder = (cache_folder(os.environ) or Path(os.devnull)) / "cpp" / key
            folder.mkdir(parents=True, exist_ok=True)
            (folder / _OF).write_text(str(source))
        except OSError:
            made = tempfile.TemporaryDirectory(prefix="lcmtools-cpp-")
            folder = Path(owned.enter_context(made), key)
            folder.mkdir()
            (folder / _OF).write_text(str(source))
        for other in folder.parent.iterdir():
            with contextlib.suppress(OSError):  # another process makes or removes it
                if not Path((other / _OF).read_text()).is_file():
                    shutil.rmtree(other)
        yield folder


def _build(folder: Path, name: str, node: str = "") -> None:
    """Build a package, or only one of its nodes, which prints nothing; ``name`` is for errors."""
    for program, package in _NEEDED.items():
        if shutil.which(program) is None:
            what = f"{name} cannot be built: '{program}' is not installed"
            raise MissingExtra(what, f"type: sudo apt install {package}")
    find_liblcm()
    build = folder / "build"
    options = [f"-DCMAKE_PREFIX_PATH={cpp_folder()}", f"-DLCMTOOLS_PROGRAM={_own_program()}"]
    source = ["-S", str(folder), "-B", str(build), "-DCMAKE_BUILD_TYPE=RelWithDebInfo"]
    target = ["--target", node] if node else []
    configure = ["cmake", "--log-level=WARNING", *source, *options]
    for command in (configure, ["cmake", "--build", str(build), *target]):
        code, printed = _quietly(command) if node else _shown(command)
        if code:
            is_include = not node or "No such file" in printed
            hint = wrong_include(folder, packages()) if is_include else ""
            hint = hint or _first_error(printed) or "correct the first error above, and build again"
            raise LcmtoolsError(f"{name} was not built", hint)


def _own_program() -> str:
    program = Path(sysconfig.get_path("scripts")) / "lcmtools"
    return str(program) if program.is_file() else shutil.which("lcmtools") or ""


def _shown(command: list[str]) -> tuple[int, str]:
    import subprocess

    done = subprocess.run(command, stdout=sys.stderr.fileno(), check=False)  # noqa: S603 - CMake
    return done.returncode, ""


def _quietly(command: list[str]) -> tuple[int, str]:
    """Run a command in English; return its code and output. Its processes end with this one's."""
    import subprocess

    with subprocess.Popen(  # noqa: S603 - CMake
        command,
        env={**os.environ, "LC_ALL": "C.UTF-8"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        text=True,
        errors="replace",
    ) as process:
        try:
            printed, _ = process.communicate()
        except BaseException:  # Ctrl-C, too
            os.killpg(process.pid, signal.SIGTERM)
            raise
    return process.returncode, printed


def _first_error(printed: str) -> str:
    """Return the first error that CMake, the compiler or the linker has printed, in one line."""
    for pattern in _ERRORS:
        if found := pattern.search(printed):
            return ": ".join(filter(None, found.groups()))
    return printed.strip().rpartition("\n")[2]
