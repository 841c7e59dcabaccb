"""The hidden node of a command while it publishes, calls services or reads parameters."""

import contextlib
import os
from collections.abc import Iterator

from lcmtools.arguments import NodeArguments
from lcmtools.bus.url import BusUrl
from lcmtools.node.node import Node
from lcmtools.node.process import open_context

_NOTHING_SAID = NodeArguments()


@contextlib.contextmanager
def temporary_node(
    tool: str,
    url: BusUrl,
    arguments: NodeArguments = _NOTHING_SAID,
    *,
    simulated: bool = False,
    in_order: bool = False,
) -> Iterator[Node]:
    """A node on a separate connection, independent of the other nodes of this process.

    The name, namespace and remaps of ``arguments`` apply. Simulated time comes from /clock.
    With ``in_order``, no message overtakes a larger one.

    Raises:
        InvalidName: A name breaks the naming rules.
        BusError: The bus cannot be reached; the error says what to type.
    """
    parameters = {"use_sim_time": "true"} if simulated else {}
    context = open_context(url, arguments._replace(parameters=parameters))
    if in_order:
        context.bus.keep_order()
    try:
        with Node(f"_lcmtools_{tool}_{os.getpid()}", tool=True, context=context) as node:
            yield node
    finally:
        context.close()
