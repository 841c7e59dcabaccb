"""Which relays carry messages, so that no message runs in a loop or arrives twice.

Pure: states in, decisions out. Each relay joins two buses. It reports on both what it knows of all
relays, so that each relay knows all joined pairs, even several buses away. A report itself is
never passed on: hearing it shows that its sender is on the same bus.

Buses have no identity: two networks may have the same group, and one bus two URLs. Therefore, two
ends count as on one bus if one of them hears the reports of the other. Those that carry messages
first, then in the order of their ids, relays carry if earlier ones do not already join their buses;
all others stand by. This makes a spanning forest, which is the same wherever it is computed. An id
begins with the time of the start: the oldest carries, and goes on until it ends or loses a bus.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from lcmtools.bounded import MOST_ENTRIES, BoundedDict
from lcmtools.graph.model import STALE_AFTER
from lcmtools.graph.relay_report import End, Link, Report, State

_DELAY = 0.7  # [s]
_DEAF = 5.0  # [s]; Zenoh detects a dead line in 4 (``bus.zenoh.config``), a server in about 1


def carrying(links: Iterable[Link]) -> frozenset[str]:
    """Return the ids of the relays that should carry messages."""
    alive = (link for link in links if link.state is not State.LEFT)
    links = sorted(alive, key=lambda one: (one.state, one.id))
    ends = [end for link in links for end in link.ends]
    buses = _Sets(end.id for end in ends)
    for end in ends:
        for heard in end.heard:
            buses.join(end.id, heard)
    found = set()
    joined = _Sets(buses.of(end.id) for end in ends)
    for link in links:
        one, other = (buses.of(end.id) for end in link.ends)
        if all(end.is_up for end in link.ends) and joined.join(one, other):
            found.add(link.id)
    return frozenset(found)


class _Sets:  # disjoint sets
    def __init__(self, members: Iterable[str]) -> None:
        self._above = {member: member for member in members}

    def of(self, member: str) -> str:
        """Return the representative of a member's set."""
        while (above := self._above[member]) != member:
            self._above[member] = self._above[above]
            member = above
        return member

    def join(self, one: str, other: str) -> bool:
        """Join two sets; return whether they were separate. Does nothing for a non-member."""
        if one not in self._above or other not in self._above:
            return False
        first, second = self.of(one), self.of(other)
        self._above[max(first, second)] = min(first, second)
        return first != second


class StartDelay:
    """The time before a relay may begin to carry, in which it hears of others.

    Over a line their reports may come late: a relay that hears others on one bus but none over the
    line may be parallel to one of them, and waits as long as it takes to detect a dead line. Times
    are ``time.monotonic()`` [s].

    Args:
        lines: The ids of the relay's ends over which messages may come late.
        now: The current time.
    """

    def __init__(self, lines: Iterable[str], now: float) -> None:
        self._lines = frozenset(lines)
        self._deaf = ""
        self.begin(now)

    def begin(self, now: float) -> None:
        """Start waiting, because a bus was lost or restored."""
        self._until, self._deaf_until = now + _DELAY, now + _DEAF

    def update(self, own: Link, now: float) -> None:
        """Update from what the relay hears."""
        deaf = {end.id for end in own.ends if not end.heard}
        self._deaf = deaf.pop() if len(deaf) == 1 and deaf <= self._lines else ""
        if not self._deaf:
            self._deaf_until = now + _DEAF

    def lasts(self, now: float) -> bool:
        """Return whether the relay must wait."""
        return now < (max(self._until, self._deaf_until) if self._deaf else self._until)

    def awaited(self, now: float) -> str:
        """Return the id of the line if the relay waits only for others on it, else ""."""
        return self._deaf if self._until <= now < self._deaf_until else ""


class KnownRelays:
    """The relays that one relay knows of, itself among them.

    Times are those of any monotonic clock [ns].
    """

    def __init__(self, own: Link) -> None:
        self.own = own
        self._others: dict[str, tuple[Link, int]] = {}  # with the time of its newest report
        self._forgotten = BoundedDict[str, int]()  # last numbers, as others may repeat these
        # When the ends of others were heard last, at each own end.
        self._heard: dict[str, dict[str, int]] = {end.id: {} for end in own.ends}

    def add_report(self, report: Report, at_end: str, now: int) -> bool:
        """Add a report that arrived at an own end; return whether more than counts changed."""
        before = self._essence()
        if report.end not in self._heard or report.end != at_end:  # not this end's own echo
            self._heard[at_end][report.end] = now
        for link in report.links:
            known = self._others.get(link.id)
            number = known[0].number if known else self._forgotten.get(link.id, -1)
            is_newer = link.number > number
            if link.id != self.own.id and is_newer and len(self._others) < MOST_ENTRIES:
                self._others[link.id] = link, now
                self._forgotten.pop(link.id, None)
        self._refresh(now)
        return self._essence() != before

    def expire(self, now: int) -> bool:
        """Forget silent relays; return whether anything changed."""
        before = self._essence()
        for link, time in list(self._others.values()):
            if now - time > (STALE_AFTER if link.state is not State.LEFT else 3 * STALE_AFTER):
                del self._others[link.id]
                self._forgotten[link.id] = link.number
        self._refresh(now)
        return self._essence() != before

    def update(self, state: State, ends: tuple[End, End]) -> None:
        """Set the current state of the relay itself, and count its next report."""
        own = self.own
        heard = [replace(new, heard=end.heard) for new, end in zip(ends, own.ends, strict=True)]
        self.own = replace(own, state=state, number=own.number + 1, ends=(heard[0], heard[1]))

    def links(self) -> tuple[Link, ...]:
        """Return all relays, this one first."""
        return (self.own, *(link for link, _ in self._others.values()))

    def carrying(self) -> frozenset[str]:
        """Return the ids of the relays that should carry messages; see ``carrying``."""
        return carrying(self.links())

    def _refresh(self, now: int) -> None:
        ends = []
        for end in self.own.ends:
            heard = self._heard[end.id]
            for silent in [one for one, last in heard.items() if now - last > STALE_AFTER]:
                del heard[silent]
            ends.append(replace(end, heard=tuple(sorted(heard))))
        self.own = replace(self.own, ends=(ends[0], ends[1]))

    def _essence(self) -> Mapping[str, object]:
        """Return everything that determines which relays carry messages."""
        return {
            link.id: (link.state, [(end.heard, end.is_up) for end in link.ends])
            for link in self.links()
        }
