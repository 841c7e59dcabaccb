"""The durations of callbacks, by what nodes count themselves. Plain arithmetic on two looks."""

from lcmtools.graph.model import Endpoint, Node

_SHORTEST = 200_000_000  # [ns] between two looks that tell how busy a node is
_TEN, _THOUSAND = 9.95, 999.5  # that rounding makes 10 and 1000


def callback_time(earlier: Endpoint, later: Endpoint) -> float | None:
    """Return the average duration of a call between two announcements [ns].

    One that runs still counts as far as it has come; None where there was none.
    """
    calls, busy = later.calls - earlier.calls, later.busy - earlier.busy
    if calls < 0 or busy <= 0:
        return None
    mean, overall = busy / max(1, calls), later.busy / max(1, later.calls)
    # the first and the last call may lie in there in part only: where the average of all calls
    # fits as well, that is the better one
    fits = calls and busy / (calls + 1) <= overall <= busy / max(1, calls - 1)
    return overall if fits else mean


def busy_share(earlier: Node, later: Node, busy: int | None = None) -> float | None:
    """Return the part of the time between two announcements spent in callbacks, 1 at most.

    Args:
        earlier: The node as it was announced.
        later: The same node, announced later.
        busy: The time in the callbacks that count [ns]; None for all of them.

    Returns:
        None where the announcements are too close, or do not say when they were sent.
    """
    span = later.sent - earlier.sent
    spent = later.busy - earlier.busy if busy is None else busy
    if not earlier.sent or span < _SHORTEST or spent < 0:
        return None
    return min(1.0, spent / span)


def duration_text(nanoseconds: float) -> str:
    """Return a time for people: "0.012 ms", "1.2 ms", "250 ms", "2.5 s"."""
    for value, unit in ((nanoseconds / 1e6, "ms"), (nanoseconds / 1e9, "s")):
        if value < _TEN:
            return f"{value:.2g} {unit}"
        if value < _THOUSAND:
            return f"{value:.0f} {unit}"
    return f"{nanoseconds / 1e9:.0f} s"
