"""Generate lcmtools/types from the .lcm files next to this script, with lcm-gen.

    python lcm_types/generate.py            write missing and outdated files, remove all others
    python lcm_types/generate.py --check    write nothing, list files that differ; then exit code 1

Belongs here: running lcm-gen and keeping the committed output up to date. companions.py writes the
stubs, fingerprints and service pairs. Must not know the meaning of any type.
"""

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import lcm

from lcmtools.packages.python_code import as_values

SOURCES = Path(__file__).resolve().parent
ROOT = SOURCES.parent
OUTPUT = ROOT / "lcmtools" / "types"
PREFIX = "lcmtools.types"

Files = dict[Path, bytes]
"""Contents of files, by their path relative to lcmtools/types."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Update lcmtools/types, or check that it is up to date; return the exit code."""
    parser = argparse.ArgumentParser(description="Write lcmtools/types from the .lcm files.")
    parser.add_argument("--check", action="store_true", help="write nothing, name stale files")
    check: bool = parser.parse_args(arguments).check
    wanted = generate()
    stale = stale_files(wanted, read_files(OUTPUT))
    if not check:
        synchronise(wanted, stale)
        print(f"{len(stale)} of {len(wanted)} files changed in {OUTPUT.relative_to(ROOT)}")
        return 0
    for path in stale:
        print(f"stale: {(OUTPUT / path).relative_to(ROOT)}")
    if stale:
        print("run: python lcm_types/generate.py", file=sys.stderr)
    return 1 if stale else 0


def generate() -> Files:
    """Generate everything into an empty folder and return it.

    The folder must be empty because lcm-gen appends to an existing ``__init__.py``.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run_lcm_gen(folder)
        run_companions(folder)
        files = read_files(folder / "lcmtools" / "types")
        return {path: as_value_file(path, content) for path, content in files.items()}


def run_lcm_gen(folder: Path) -> None:
    """Let lcm-gen write its classes into ``folder``; exit with its exit code if it fails."""
    # Sorted, because each __init__.py has its lines in the order of the arguments.
    sources = sorted(str(path) for path in SOURCES.glob("*/*.lcm"))
    options = ["--python", "--ppath", str(folder), "--package-prefix", PREFIX]
    code = lcm.run_script("lcm-gen", [*options, *sources])
    if code != 0:
        sys.exit(code)


def run_companions(folder: Path) -> None:
    """Write stubs, fingerprints and service pairs next to the classes in ``folder``.

    A separate process without site-packages imports the new classes, so that it cannot import
    those of an installed lcmtools instead.
    """
    script = SOURCES / "companions.py"
    subprocess.run(  # noqa: S603 - our own script with our own interpreter
        [sys.executable, "-I", "-S", "-B", "-W", "error", str(script), str(folder)], check=True
    )


def as_value_file(path: Path, content: bytes) -> bytes:
    """Return a file's content; a message class is derived from ``lcmtools.message_value``."""
    if path.suffix != ".py":
        return content
    is_package = path.name == "__init__.py" and path.parent.name
    text = content.decode()
    return (as_lazy_package(text) if is_package else as_values(text)).encode()


def as_lazy_package(text: str) -> str:
    """Return the ``__init__.py`` of a package that imports a type when it is first used.

    Type checkers see the imports that lcm-gen wrote.
    """
    head, sign, imports = text.partition("from .")
    rows = f"{sign}{imports}".splitlines()
    names = [row.split()[-1] for row in rows]
    return (
        f"{head}import sys\n\nfrom lcmtools.message_value import LazyPackage\n\n"
        "TYPE_CHECKING = False\nif TYPE_CHECKING:\n"
        f"{''.join(f'    {row}{chr(10)}' for row in rows)}"
        f"\n__all__ = {names!r}\nsys.modules[__name__].__class__ = LazyPackage\n"
    )


def read_files(folder: Path) -> Files:
    """Return the contents of all files under ``folder`` except Python's caches."""
    return {
        path.relative_to(folder): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }


def stale_files(wanted: Files, present: Files) -> list[Path]:
    """Return the paths of missing, different and superfluous files, sorted."""
    paths = wanted.keys() | present.keys()
    return sorted(path for path in paths if wanted.get(path) != present.get(path))


def synchronise(wanted: Files, stale: Sequence[Path]) -> None:
    """Write or remove the stale files in lcmtools/types."""
    for path in stale:
        target = OUTPUT / path
        if path in wanted:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(wanted[path])
        else:
            target.unlink()


if __name__ == "__main__":
    sys.exit(main())
