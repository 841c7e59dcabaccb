"""Which relays carry messages, so that no message runs in a loop or arrives twice.

Pure: states in, decisions out. Each relay joins two buses. It reports on both what it knows of all
relays, so that each relay knows all joined pairs, even several buses away. A report itself is
never passed on: hearing it shows that its sender is on the same bus.

Buses have no identity: two networks may have the same group, and one bus two URLs. Therefore, two
ends count as on one bus if one of them hears the reports of the other. In the order of their ids,
relays carry messages if earlier ones do not already join their buses; all others stand by. This
makes a spanning forest, which is the same wherever it is computed. An id begins with the time of
the start, so that the oldest relay stays active when another one comes.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

from lcmtools.graph.model import STALE_AFTER
from lcmtools.graph.relay_report import End, Knowledge, Link, State
from lcmtools.wire.packet import Sender

_MOST_RELAYS = 1000


def carrying(links: Iterable[Link]) -> frozenset[str]:
    """Return the ids of the relays that should carry messages."""
    links = sorted((link for link in links if link.state is not State.LEFT), key=lambda one: one.id)
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


class _Heard(NamedTuple):  # the latest report of another relay's end at an own end
    time: int  # [ns]
    address: str  # of its sender, if the bus shows it


class KnownRelays:
    """The relays that one relay knows of, itself among them.

    Times are those of any monotonic clock [ns].
    """

    def __init__(self, own: Link) -> None:
        self.own = own
        self._others: dict[str, tuple[Link, int]] = {}  # with the time of its newest report
        self._forgotten: dict[str, int] = {}  # with their last numbers, as others may repeat these
        self._heard: dict[str, dict[str, _Heard]] = {end.id: {} for end in own.ends}

    def add_report(self, report: Knowledge, at_end: str, now: int, address: str = "") -> bool:
        """Add a report that arrived at an own end; return whether more than counts changed.

        ``address`` is its sender's, if the bus shows it.
        """
        before = self._essence()
        if report.end not in self._heard or report.end != at_end:  # not this end's own echo
            self._heard[at_end][report.end] = _Heard(now, address)
        for link in report.links:
            known = self._others.get(link.id)
            number = known[0].number if known else self._forgotten.get(link.id, -1)
            is_newer = link.number > number
            if link.id != self.own.id and is_newer and len(self._others) < _MOST_RELAYS:
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
                if len(self._forgotten) >= _MOST_RELAYS:
                    self._forgotten.clear()
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

    def idle(self, at_end: str, active: Collection[str]) -> frozenset[Sender]:
        """Return the senders at an own end that belong to relays which should not carry."""
        heard = self._heard[at_end]
        others = (end for link in self.links()[1:] if link.id not in active for end in link.ends)
        ends = ((heard[end.id].address, end.ports) for end in others if end.id in heard)
        return frozenset(Sender(address, port) for address, ports in ends for port in ports)

    def _refresh(self, now: int) -> None:
        ends = []
        for end in self.own.ends:
            heard = self._heard[end.id]
            for silent in [one for one, last in heard.items() if now - last.time > STALE_AFTER]:
                del heard[silent]
            ends.append(replace(end, heard=tuple(sorted(heard))))
        self.own = replace(self.own, ends=(ends[0], ends[1]))

    def _essence(self) -> Mapping[str, object]:
        """Return everything that determines which relays carry messages."""
        return {
            link.id: (link.state, [(end.heard, end.is_up, end.ports) for end in link.ends])
            for link in self.links()
        }
