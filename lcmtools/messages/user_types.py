"""Types of the user's own, for who makes or imports them rather than uses them.

Belongs here: compiling folders, the .lcm files behind types, and modules whose names are types.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from lcmtools.errors import UnknownType
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import (
    Message,
    default_registry,
    message_class,
    packages,
    type_name,
    type_names,
    user_types,
)
from lcmtools.names import did_you_mean
from lcmtools.packages.source import TypeSource
from lcmtools.packages.type_files import shipped_folder


def compile_folders(folders: Sequence[Path]) -> TypeSource:
    """The types of the .lcm files in some folders, made now; with what is wrong with others."""
    return user_types().compiled(folders)


def sources_of(words: Sequence[str]) -> list[Path]:
    """The .lcm files of types, and of all types that these are made of, sorted.

    Args:
        words: Types, or packages; none for all of the user's own.

    Raises:
        UnknownType: There is no such type or package, or no type of the user's own.
        InvalidFile: A .lcm file is wrong.
    """
    own = default_registry().files()
    names: set[str] = set()
    for word in words or own:
        _add_parts([word] if word in own else _named(word), names)
    if not names:
        raise UnknownType("there are no types of your own", "name types, or set LCMTOOLS_TYPE_PATH")
    shipped = shipped_folder()
    return sorted({Path(own.get(name) or shipped / f"{name}.lcm") for name in names})


def package_messages(module: str, file: str) -> Callable[[str], type[Message]]:
    """What makes ``from air_lab0.msg import Stat`` work: the ``__getattr__`` of air_lab0/msg.

    Args:
        module: The module's ``__name__``: "air_lab0.msg".
        file: Its ``__file__``: its workspace counts, wherever the program was started.
    """
    package = module.rpartition(".")[0] or module

    def find(name: str) -> type[Message]:
        if name.startswith("_"):
            raise AttributeError(f"module '{module}' has no attribute '{name}'")
        user_types().add_start(Path(file).resolve().parent)
        try:
            return message_class(f"{package}/{name}")
        except UnknownType as error:
            raise AttributeError(str(error)) from None

    return find


def _named(word: str) -> list[str]:
    """The types that a package has, or the one of the name."""
    of_package = [name for name in type_names() if name.startswith(f"{word}/")]
    try:
        return of_package or [type_name(message_class(word))]
    except UnknownType:
        near = did_you_mean(word, packages())
        if "/" in word or not near:
            raise
        raise UnknownType(f"there is no package '{word}'", near) from None


def _add_parts(names: Iterable[str], known: set[str]) -> None:
    """Add types and those that their fields have."""
    for name in names:
        if name not in known:
            known.add(name)
            parts = (part.message_class for part in fields(message_class(name)))
            _add_parts((type_name(cls) for cls in parts if cls), known)
