"""Logs: recording a bus; playing, inspecting, editing and exporting logs.

The logs are LCM's own, with an index beside them (``wire/log_index``); ``observe`` reads them as a
stream of arrivals. Nothing here prints or knows a command line.
The public names are ``open`` and the ``Log`` that it returns, and ``rerun``, which tests a program
with a log:

    with lcmtools.bag.open("ride.lcmlog") as log:
        for arrival in log.messages("/husky0/odometry"):
            print(arrival.time, arrival.sender, arrival.message.pose.pose.position.x)
    assert lcmtools.bag.rerun("ride.lcmlog", "lcmtools run simple_controller __ns:=/husky0")
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lcmtools.bag.log import Log as Log
    from lcmtools.bag.log import open_log as open  # noqa: A004 - as in gzip
    from lcmtools.bag.rerunning.rerun import rerun as rerun
    from lcmtools.bag.rerunning.rerun_report import Rerun as Rerun
    from lcmtools.bag.rerunning.session import Input as Input

__all__ = ["Input", "Log", "Rerun", "open", "rerun"]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used (PEP 562)."""
    if name not in __all__:
        raise AttributeError(f"module 'lcmtools.bag' has no attribute '{name}'")
    if name in ("Log", "open"):
        from lcmtools.bag import log

        return log.open_log if name == "open" else log.Log
    from lcmtools.bag.rerunning import rerun

    return getattr(rerun, name)
