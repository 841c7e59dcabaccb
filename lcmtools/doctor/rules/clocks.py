"""Rules about the clocks of computers."""

from collections.abc import Iterator

from lcmtools.doctor.computers import HostClock
from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.observe.callbacks import duration_text

_AHEAD = 0.1  # [s] that a clock may be: what is sent cannot arrive before
_BEHIND = 0.3  # [s]: a slow network looks the same
_MOST = 6  # nodes that are named


@rule(
    "clocks", Severity.WARNING, "sudo timedatectl set-ntp true, on both; or sudo chronyc makestep"
)
def clocks_agree(evidence: Evidence) -> Iterator[Finding]:
    """The clocks of all computers agree.

    Nodes say when they announce themselves, by their own computer's clock. What comes before it was
    sent, or much later, tells that one of the two clocks is wrong; then stamps, delays and what is
    computed from them are wrong too. Which of the two it is does not show.
    """
    for clock in wrong_clocks(evidence):
        more = len(clock.nodes) - _MOST
        yield Finding(
            "clocks",
            Severity.WARNING,
            f"The clock of {clock.host} ({clock.address}) is {_offset(clock)} this computer's:",
            tuple(f" * {name}" for name in clock.nodes[:_MOST])
            + ((f" * and {more} more",) if more > 0 else ()),
            (
                "let both computers keep the time: sudo timedatectl set-ntp true",
                "compare them: chronyc tracking, or timedatectl timesync-status",
            ),
        )


def wrong_clocks(evidence: Evidence) -> list[HostClock]:
    """The computers whose clocks differ from this one's."""
    return [c for c in evidence.clocks if c.lag < -_AHEAD or c.lag > _BEHIND]


def is_of_wrong_clock(evidence: Evidence, name: str) -> bool:
    """Whether a sender, as people call it, is on a computer whose clock differs."""
    return any(
        name in clock.nodes or name.startswith(f"{clock.address}:")
        for clock in wrong_clocks(evidence)
    )


def _offset(clock: HostClock) -> str:
    text = duration_text(abs(clock.lag) * 1e9)
    return f"{text} ahead of" if clock.lag < 0 else f"{text} behind"
