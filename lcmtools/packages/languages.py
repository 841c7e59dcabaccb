"""lcm-gen's code for other languages, of .lcm files.

Belongs here: lcm-gen's options for a language, and that all files are written or none. Must not
know which types there are.
"""

import shutil
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from lcmtools.errors import LcmtoolsError
from lcmtools.packages.lcm_gen import run_lcm_gen

_OPTIONS = {
    "c": ("--c", "--c-cpath", "{}", "--c-hpath", "{}"),
    "cpp": ("--cpp", "--cpp-std", "c++11", "--cpp-hpath", "{}"),
    "java": ("--java", "--jpath", "{}"),
    "python": ("--python", "--ppath", "{}"),
}
LANGUAGES = tuple(_OPTIONS)


def generate(files: Iterable[Path], language: str, folder: Path) -> list[Path]:
    """Write the code of some .lcm files into a folder; return the files, sorted.

    What is in the folder stays; files of the same names are overwritten.

    Raises:
        InvalidFile: lcm-gen refuses a file; then nothing is written.
        LcmtoolsError: The folder cannot be written.
        MissingExtra: There is no lcm-gen.
    """
    with tempfile.TemporaryDirectory(prefix="lcmtools-generate-") as name:
        scratch = Path(name)
        options = [word.format(scratch) for word in _OPTIONS[language]]
        for file in files:
            problem = run_lcm_gen(file, options)
            if problem:
                raise problem.error()
        made = sorted(path.relative_to(scratch) for path in scratch.rglob("*") if path.is_file())
        try:
            _copy(made, scratch, folder)
        except OSError as error:
            where = error.filename or folder
            raise LcmtoolsError(f"cannot write {where}: {error.strerror}") from error
    return [folder / path for path in made]


def _copy(made: Sequence[Path], source: Path, target: Path) -> None:
    for path in made:
        (target / path).parent.mkdir(parents=True, exist_ok=True)
        if path.name == "__init__.py" and (target / path).exists():
            _join(source / path, target / path)
        else:
            shutil.copyfile(source / path, target / path)


def _join(new: Path, old: Path) -> None:
    """Keep what an earlier run has put into a package, as lcm-gen itself does."""
    known = old.read_text("utf-8").splitlines()
    more = [line for line in new.read_text("utf-8").splitlines() if line.startswith("from ")]
    old.write_text("\n".join([*known, *(line for line in more if line not in known), ""]), "utf-8")
