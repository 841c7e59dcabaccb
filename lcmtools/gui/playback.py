"""Requests for a log: its time line, and playing it."""

from typing import Annotated

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.typed import Within
from lcmtools.gui.log_source import LogSource
from lcmtools.gui.protocol import Json, MalformedRequest
from lcmtools.gui.source import Source

_DAY = 86_400.0
_SLOWEST, _FASTEST = 1 / 64, 64.0


def timeline(source: Source) -> Json:
    """Return the time line of the log."""
    return _log(source).timeline()


def play(
    source: Source,
    *,
    action: str,
    time: Annotated[float, Within(-_DAY, 1000 * _DAY)] = 0.0,
    rate: Annotated[float, Within(_SLOWEST, _FASTEST)] = 1.0,
) -> Json:
    """Execute ``action``: "play", "pause", "step", "seek" to ``time``, or "rate"."""
    log = _log(source)
    plain = {"play": log.resume, "pause": log.pause, "step": log.step}
    if action in plain:
        plain[action]()
    elif action == "seek":
        log.seek(time)
    elif action == "rate":
        log.set_rate(rate)
    else:
        raise MalformedRequest(f"a log cannot '{action[:40]}'")
    return None


def _log(source: Source) -> LogSource:
    if not isinstance(source, LogSource):
        raise LcmtoolsError("a bus cannot be played", "lcmtools gui --bag FILE opens a log")
    return source
