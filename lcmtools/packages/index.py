"""The table of what has been made of .lcm files, as a file.

Belongs here: reading it, which every look-up of a user's type does; ``build`` writes it.
"""

import json
from pathlib import Path

from lcmtools.messages.type_source import Problem, TypeSource

INDEX = "index.json"


def read_index(prefix: str, folder: Path) -> TypeSource:
    """The table of a folder that ``build`` has filled.

    Raises:
        OSError: There is none.
        ValueError: It is broken.
    """
    table = json.loads((folder / INDEX).read_text("utf-8"))
    return TypeSource(
        prefix,
        {name: int(digits, 16) for name, digits in table["fingerprints"].items()},
        table["services"],
        table["files"],
        [Problem(**problem) for problem in table["problems"]],
        table["notes"],
    )
