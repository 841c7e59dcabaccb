"""The node that a command is while it publishes.

Belongs here: its name, its names and its clock. Must not know what it publishes.
"""

import contextlib
import os
from collections.abc import Iterator, Sequence
from functools import partial

import lcmtools
from lcmtools.arguments import NodeArguments
from lcmtools.cli.options import chosen_url
from lcmtools.errors import NothingReceived
from lcmtools.publish.subscriber_wait import wait_until


@contextlib.contextmanager
def own_node(names: NodeArguments, *, simulated: bool) -> Iterator[lcmtools.Node]:
    """A node of this command's own.

    Raises:
        InvalidName: A name breaks the naming rules.
        BusError: The bus cannot be reached.
    """
    arguments = [*_as_arguments(names), *(["_use_sim_time:=true"] if simulated else [])]
    lcmtools.init(arguments, url=str(chosen_url()), handle_signals=False)
    try:
        with lcmtools.Node(f"_lcmtools_pub_{os.getpid()}", tool=True) as node:
            yield node
    finally:
        lcmtools.shutdown()


def _as_arguments(names: NodeArguments) -> Sequence[str]:
    """The naming arguments among the values, for the node."""
    return [
        *([f"__ns:={names.namespace}"] if names.namespace else []),
        *([f"__name:={names.name}"] if names.name else []),
        *(f"{source}:={target}" for source, target in names.remaps),
        *(["--lcm-url", names.lcm_url] if names.lcm_url else []),
        *(["--domain", names.domain] if names.domain else []),
    ]


def wait_for_clock(node: lcmtools.Node, timeout: float | None) -> None:
    """Wait until the simulation's time is known.

    Raises:
        NothingReceived: It does not come within the time.
    """
    pause = partial(lcmtools.spin_once, node)
    if not wait_until(node.get_clock().now, timeout, lambda: "waiting for /clock", pause):
        raise NothingReceived(
            f"nothing came on /clock within {timeout:g} s", "is the simulator running?"
        )
