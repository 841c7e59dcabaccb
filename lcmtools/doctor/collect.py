"""Collecting the evidence: all that ``wtf`` reads from the outside, once."""

import contextlib
from collections.abc import Mapping

from lcmtools.bus.url import BusUrl
from lcmtools.bus.watch import Watch
from lcmtools.doctor.model import Evidence
from lcmtools.errors import BusError


def collect(url: BusUrl, environment: Mapping[str, str], listen: float) -> Evidence:
    """Look at a bus for ``listen`` seconds. A bus that does not work is evidence, not an error."""
    try:
        with Watch(url, "wtf", environment) as watch:
            watch.settle(foreign=False)
            with contextlib.suppress(EOFError):  # a log has ended
                for _ in watch.packets(listen):
                    pass
            return Evidence(
                url=str(url),
                graph=watch.graph(),
                listened=listen,
                malformed=tuple(watch.malformed().items()),
            )
    except BusError as error:
        return Evidence(url=str(url), bus_problem=error.what, bus_remedy=error.hint)
