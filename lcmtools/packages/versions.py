"""Other definitions of types: versions, in other folders, of types with the same names.

Belongs here: which files are a version, and which of two definitions a name means. Must not know
how files are compiled.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.messages.type_source import TypeSource
from lcmtools.packages.type_files import LcmFile

Compile = Callable[[Sequence[LcmFile], Mapping[str, int], str], TypeSource]
"""Compiles files; takes the fingerprints of further types for their fields, and their package."""


def version_place(file: Path, first: Path) -> Path:
    """Return the folder of another version of a type, beside or below that of the first.

    It is the outermost one without the first; the file itself if both are in one folder.
    """
    common = Path(os.path.commonpath([file.parent, first.parent]))
    if file.parent != common:
        return common / file.relative_to(common).parts[0]
    return file if first.parent == common else common


def with_versions(
    source: TypeSource, files: Sequence[LcmFile], shipped: Mapping[str, int], compiled: Compile
) -> TypeSource:
    """Add the other versions of a source's types.

    The files of each of its ``places`` are compiled once more, and there take precedence. So the
    types that are made of these versions are known too, and if they are defined there, their names
    mean these.
    """
    known = {**shipped, **source.enums, **source.fingerprints}
    versions: list[TypeSource] = []
    mixed: dict[str, int] = {}  # types made of types of another folder
    for place in source.places:
        inside = [one for one in files if f"{one.where}/".startswith(f"{place}/")]
        inside.sort(key=lambda one: len(one.path.parts))
        for one in compiled(inside, known, source.prefix).with_versions():
            new = {n: f for n, f in one.fingerprints.items() if known.get(n) != f}
            versions += [TypeSource(one.prefix, new, files=one.files)] if new else []
            mixed |= {n: known[n] for n in new if one.files[n] == source.files.get(n)}
    versions += [TypeSource(source.prefix, mixed, files=source.files)] if mixed else []
    own = {n: f for n, f in source.fingerprints.items() if n not in mixed}
    return source._replace(fingerprints=own, versions=versions)
