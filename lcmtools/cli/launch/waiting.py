"""Waiting until the bus works, as a computer may start nodes before its network is up."""

import time

from lcmtools.bus.preflight import check_bus
from lcmtools.bus.url import BusUrl
from lcmtools.cli.output import talk
from lcmtools.errors import BusError

_PERIOD = 0.2  # [s] between two looks


def wait_for_bus(url: BusUrl) -> None:
    """Return when the bus can be used; what is wrong with it is said once."""
    has_told = False
    while (problem := _problem(url)) is not None:
        if not has_told:
            talk(f"lcmtools launch: waiting for the bus: {problem}")
        has_told = True
        time.sleep(_PERIOD)


def _problem(url: BusUrl) -> BusError | None:
    try:
        check_bus(url)
    except BusError as error:
        return error
    return None
