"""Users' own packages: finding them and their nodes, and importing their message types.

Belongs here: folders with a pyproject.toml or .lcm files, the types in these, lcm-gen, and the text
of a new package. Must not know the bus, the content of messages, or printing. The environment
comes in as an argument.
"""

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.errors import UsageError, explained
from lcmtools.messages.supply import Supply, has_supply, set_supply

if TYPE_CHECKING:  # imported at the first look-up
    from lcmtools.messages.registry import Message
    from lcmtools.wire.log_index import RecordedType


def provide_user_types() -> None:
    """Let look-ups of types also find the types of this process's user.

    Reads the environment, the working directory and the script's folder now, and the .lcm files
    found through them at the first look-up. Call it at the edge of a program: a command, a node, a
    notebook.
    """
    environment = dict(os.environ)
    script = Path(sys.argv[0] if sys.argv and sys.argv[0] else ".").absolute().parent
    starts = [script] if script.name != "bin" else []
    with suppress(OSError):  # the working directory may have been removed
        starts.insert(0, Path.cwd())

    def make() -> Supply:
        from lcmtools.messages.registry import shipped_types
        from lcmtools.packages.user_types import UserTypes

        return UserTypes(environment, starts, shipped_types().fingerprints)

    set_supply(make)


def provide_recorded_types(types: "Iterable[RecordedType]") -> None:
    """Let look-ups find the types of a log, for messages that no other known type fits."""
    if not (types := list(types)):
        return
    from lcmtools.packages.user_types import user_types

    user_types().add_recorded(types)


@explained
def message_class(name: str, number: int | None = None) -> "type[Message]":
    """Return the class of a message type, shipped or the user's own.

    Args:
        name: geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or, if only one
            package has it, Twist.
        number: Its fingerprint, if known: it chooses among types with the same name.

    Raises:
        UsageError: The name is not a string.
        UnknownType: There is no such type, or several packages have it.
        InvalidFile: The .lcm file that should define it is wrong.
    """
    from lcmtools.messages import registry

    if not isinstance(name, str):
        what = f"message_class: a type's name is a text, got {name!r}"
        raise UsageError(what, "write lcmtools.message_class('std_msgs/String')")
    if not has_supply():
        provide_user_types()
    return registry.message_class(name, number)
