"""Nodes in C++: the folder of their headers, liblcm, and the flags of a compiler.

Belongs here: finding what ``cpp/lcmtools/node.hpp`` is compiled with. Must not know CMake projects.
"""

import shutil
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from lcmtools.errors import MissingExtra


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
