"""Observing a bus or a log: arrivals, types, rates, losses, senders, listeners.

Nothing here prints or knows a command line. The public names are ``messages`` and the ``Arrival``
that it yields:

    for arrival in lcmtools.observe.messages("/husky0/odometry"):
        print(arrival.time, arrival.sender, arrival.message.pose.pose.position.x)
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lcmtools.observe.reading.received import Arrival as Arrival
    from lcmtools.observe.reading.received import messages as messages

__all__ = ["Arrival", "messages"]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used (PEP 562)."""
    if name not in __all__:
        raise AttributeError(f"module 'lcmtools.observe' has no attribute '{name}'")
    from lcmtools.observe.reading import received

    return getattr(received, name)
