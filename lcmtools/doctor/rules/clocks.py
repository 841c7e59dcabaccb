"""Rules about the clocks of computers."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, HostClock
from lcmtools.doctor.findings import Finding, Subject, finding, rule, state

_AHEAD = 0.1  # [s] that a clock may be: a message cannot arrive before it was sent
_BEHIND = 0.3  # [s]: a slow network looks the same
_MOST = 6  # nodes that are named


@rule("clocks", "sudo timedatectl set-ntp true, on both; or sudo chronyc makestep")
def clocks_agree(evidence: Evidence) -> Iterator[Finding]:
    """The clocks of all computers agree.

    Announcements of nodes hold the time at which they were sent, by their own computer's clock. If
    one comes before it was sent, or much later, one of the two clocks is wrong; then stamps, delays
    and all that is computed from them are wrong too. Which of the two it is does not show.
    """
    for clock in wrong_clocks(evidence):
        facts = [state("program", program=Subject("node", name)) for name in clock.nodes[:_MOST]]
        if len(clock.nodes) > _MOST:
            facts.append(state("more", count=len(clock.nodes) - _MOST))
        kind = "clock-ahead" if clock.lag < 0 else "clock-behind"
        title = state(kind, host=clock, seconds=abs(clock.lag))
        yield finding(title, facts, "set-clocks", "compare-clocks")


def wrong_clocks(evidence: Evidence) -> list[HostClock]:
    """The computers whose clocks differ from this one's."""
    return [c for c in evidence.clocks if c.lag < -_AHEAD or c.lag > _BEHIND]


def has_wrong_clock(evidence: Evidence, name: str) -> bool:
    """Return whether a sender, by its name for people, is on a computer whose clock differs."""
    return any(
        name in clock.nodes or name.startswith(f"{clock.address}:")
        for clock in wrong_clocks(evidence)
    )
