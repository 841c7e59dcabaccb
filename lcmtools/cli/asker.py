"""The hidden node of a command that asks other nodes: services, parameters."""

import contextlib
import os
from collections.abc import Iterator

import lcmtools
from lcmtools.cli.options import chosen_url


@contextlib.contextmanager
def asking_node(tool: str) -> Iterator[lcmtools.Node]:
    """A node of this command's own, on the bus that the command line means.

    Raises:
        UsageError: The URL or the domain is wrong.
        BusError: The bus cannot be reached, with what to type.
    """
    lcmtools.init([], url=str(chosen_url()), handle_signals=False)
    try:
        with lcmtools.Node(f"_lcmtools_{tool}_{os.getpid()}", tool=True) as node:
            yield node
    finally:
        lcmtools.shutdown()
