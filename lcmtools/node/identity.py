"""The identity of a node on the bus: its name, its process, its start."""

import os
import sys
import time
import uuid

from lcmtools.graph.model import Node


def identity(name: str, host: str, *, tool: bool) -> Node:
    """A node of this process as it is announced, still without endpoints.

    Args:
        name: Its full name.
        host: Name of this computer.
        tool: It is a command that looks at the bus, not a part of the system.
    """
    return Node(
        name=name,
        id=uuid.uuid4().hex,
        host=host,
        pid=os.getpid(),
        start_time=time.time_ns(),
        command=" ".join(sys.argv),
        tool=tool,
    )
