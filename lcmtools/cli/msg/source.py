"""The .lcm file of a message type, as its author wrote it, comments and all."""

from pathlib import Path

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import Message, default_registry, type_name
from lcmtools.packages.type_files import shipped_folder


def source_text(kind: type[Message]) -> str:
    """The text of the file that a type was made from.

    Raises:
        LcmtoolsError: The file cannot be read.
    """
    name = type_name(kind)
    file = default_registry().files().get(name) or f"{shipped_folder() / name}.lcm"
    try:
        return Path(file).read_text("utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise LcmtoolsError(f"cannot read {file}, where {name} is from: {error}") from error
