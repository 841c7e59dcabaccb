"""Requests for a log: its time line, and playing it."""

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.log_source import LogSource
from lcmtools.gui.protocol import Json, MalformedRequest, Parameters
from lcmtools.gui.source import Source

_DAY = 86_400.0
_SLOWEST, _FASTEST = 1 / 64, 64.0


def timeline(source: Source, _: Parameters) -> Json:
    """Return the time line of the log."""
    return _log(source).timeline()


def play(source: Source, parameters: Parameters) -> Json:
    """Execute ``action``: "play", "pause", "step", "seek" to ``time``, or "rate"."""
    log, action = _log(source), parameters.text("action")
    plain = {"play": log.resume, "pause": log.pause, "step": log.step}
    if action in plain:
        plain[action]()
    elif action == "seek":
        log.seek(parameters.number("time", None, -_DAY, 1000 * _DAY))
    elif action == "rate":
        log.set_rate(parameters.number("rate", None, _SLOWEST, _FASTEST))
    else:
        raise MalformedRequest(f"a log cannot '{action[:40]}'")
    return None


def _log(source: Source) -> LogSource:
    if not isinstance(source, LogSource):
        raise LcmtoolsError("a bus cannot be played", "lcmtools gui --bag FILE opens a log")
    return source
