"""A relay, which carries messages between two buses and shows the nodes of each on the other.

No message comes back, runs in a loop or arrives twice. A relay never receives its own messages:
they come from its own ports, or are a server's echo. If there are several relays, those that
``topology`` chooses carry messages; the others stand by and pass nothing on. A relay waits before
it carries, to hear of others first (``topology.StartDelay``).

When a carrying relay says goodbye, another one takes its place at once; when it is killed, after
the time in which silent nodes become stale.
"""

import contextlib
import os
import socket
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import NoReturn

from lcmtools.bus.records import NodeRecords, this_process
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.graph import protocol
from lcmtools.graph.model import RelayStep
from lcmtools.graph.relay_report import End, Link, Report, State, decode_report, encode_report
from lcmtools.names import check_node
from lcmtools.observe.reading.presence import Presence
from lcmtools.relay.announcing import Announced
from lcmtools.relay.ends import bus_name, open_end
from lcmtools.relay.fair_queue import LineMessage
from lcmtools.relay.rules import Direction, Rules
from lcmtools.relay.side import Side
from lcmtools.relay.topology import KnownRelays, StartDelay
from lcmtools.wire.packet import Packet

_EARLY = 0.1  # [s] between reports before it carries: any message on LCM may be lost
_TURN = 0.05  # [s]
_WAIT = 0.1  # [s]
_SOON = 0.25  # [s] at least between two announcements of what was heard
_SWITCH = 0.0002  # [s] that one thread may run while another one is ready
_FLUSH = 0.5  # [s] at most at the end, for waiting messages


class Relay(AbstractContextManager["Relay"]):
    """A relay between two buses, here and there, on its own threads within its context.

    ``notify`` is called with a sentence when a problem begins or ends; ``on_shutdown`` when another
    program requests this one to end. Without a name, the relay's node is named after its computer
    and process.

    Raises:
        BusError: A bus cannot be reached; the error says what to type.
    """

    def __init__(
        self,
        urls: tuple[BusUrl, BusUrl],
        rules: Rules,
        notify: Callable[[str], None],
        *,
        name: str = "",
        on_shutdown: Callable[[], None] = lambda: None,
    ) -> None:
        node = this_process(name or usual_name(), tool=False)
        check_node(node.name)
        identifier = f"{time.time_ns():016x}-{os.urandom(4).hex()}"
        node = node._replace(id=identifier)
        self._notify, self._rules = notify, rules
        self._sides = self._open(identifier, urls, rules)
        here, there = self._sides
        ends = here.state(), there.state()
        self._known = KnownRelays(Link(identifier, node.name, node.host, ends))
        self._presences = []
        for side, url in zip(self._sides, urls, strict=True):
            own, records = node._replace(ports=side.end.ports[1:]), NodeRecords(url, os.environ)
            self._presences.append(Presence(own, side.send_first, on_shutdown, records))
        self._announced = []
        for one, other in ((here, there), (there, here)):
            step, ways = RelayStep(identifier, node.name, one.bus), (one.direction, other.direction)
            self._announced.append(Announced(step, *ways, one_way=rules.one_way))
        self._owes, self._rested = [False, False], [0.0, 0.0]  # answers to probes, and until when
        self._lock = threading.RLock()
        self._carries = False
        lines = (side.identifier for side in self._sides if not side.end.is_quick)
        self._delay = StartDelay(lines, time.monotonic())
        self._next_report = self._next_observed = 0.0
        self._error: BaseException | None = None
        self._troubles = ["", ""]
        self._has_notified: bool | None = None
        self._awaited = ""
        self._said_left_out = set[str]()
        self._ends = threading.Event()
        self._stopped = threading.Event()
        self._threads = [
            threading.Thread(target=target, args=(index,), name=f"relay {index}", daemon=True)
            for index in (0, 1)
            for target in (self._receive, self._send)
        ]

    def __enter__(self) -> "Relay":
        """Begin."""
        for thread in self._threads:
            thread.start()
        for side in self._sides:
            side.send_first(protocol.PROBE_CHANNEL, protocol.encode_probe(protocol.Probe()))
        return self

    def __exit__(self, *_: object) -> None:
        """Send waiting messages for a moment, say goodbye and leave the buses."""
        self._ends.set()
        deadline = time.monotonic() + _FLUSH
        while any(side.queue for side in self._sides) and time.monotonic() < deadline:
            time.sleep(0.005)
        self._stopped.set()
        for side in self._sides:
            side.queue.close()
        for thread in self._threads:
            thread.join(1.0)
        self._known.update(State.LEFT, self._states())
        for side, presence in zip(self._sides, self._presences, strict=True):
            side.queue.clear()
            with contextlib.suppress(BusError):
                report = Report(side.identifier, (self._known.own,))
                side.end.send(LineMessage(protocol.RELAY_CHANNEL, encode_report(report)))
            presence.send = side.send_now
            presence.announce(leaving=True)
            side.end.close()

    @property
    def link(self) -> Link:
        """The state of its last report; after its context that of its end, with all counts."""
        return self._known.own

    def turn(self) -> Link:
        """Do pending work, waiting for a moment; return the relay's state."""
        self._ends.wait(_TURN)
        if self._error is not None:
            raise self._error
        now = time.monotonic()
        with self._lock:
            changed = self._known.expire(time.monotonic_ns()) | self._tell_troubles(now)
            early = self._waits(now) and now + protocol.PERIOD - _EARLY >= self._next_report
            if changed or early or now >= self._next_report:
                self._report(now)
            self._decide(now)
            self._tell_observed(now)
            self._say_left_out()
            for index in (0, 1):
                self._answer_owed(index)
            for presence in self._presences:
                presence.attend()
            return replace(self._known.own, ends=self._states())

    @staticmethod
    def _open(identifier: str, urls: tuple[BusUrl, BusUrl], rules: Rules) -> tuple[Side, Side]:
        with contextlib.ExitStack() as closing:
            sides = []
            for number, url in enumerate(urls):
                end = open_end(url)
                closing.callback(end.close)
                direction = Direction(rules, back=bool(number))
                sides.append(Side(f"{identifier}/{number}", bus_name(url), end, direction))
            closing.pop_all()
        return sides[0], sides[1]

    def _states(self) -> tuple[End, End]:
        here, there = self._sides
        return here.state(there), there.state(here)

    def _receive(self, index: int) -> None:
        side, other = self._sides[index], self._sides[1 - index]
        with self._kept_errors():
            while not self._ends.is_set():
                packets = side.end.receive(_WAIT)
                of_protocol, passed = side.sort(packets, other, passes=self._carries)
                if passed:
                    other.send(passed)
                if of_protocol:
                    self._hear_all(index, of_protocol)

    def _send(self, index: int) -> None:
        with self._kept_errors():
            while not self._stopped.is_set():
                self._sides[index].send_waiting()

    @contextlib.contextmanager
    def _kept_errors(self) -> Iterator[None]:
        """Keep an error of a thread, for ``turn`` to raise."""
        try:
            yield
        except Exception as error:  # noqa: BLE001 - raised on the owner's thread
            self._error = error
            self._ends.set()

    def _hear_all(self, index: int, of_protocol: list[Packet]) -> None:
        with self._lock:
            for packet in of_protocol:
                self._hear(index, packet)

    def _hear(self, index: int, packet: Packet) -> None:
        if packet.channel == protocol.NODE_CHANNEL:
            self._pass_announcement(index, packet)
        elif packet.channel == protocol.RELAY_CHANNEL:
            report = decode_report(packet.payload)
            end, now = self._sides[index].identifier, time.monotonic_ns()
            if report and self._known.add_report(report, end, now):
                self._repeat_latched(index)  # for a relay that is new or was cut off
                self._report(time.monotonic())
                self._decide(time.monotonic())
        else:
            if packet.channel == protocol.PROBE_CHANNEL:
                self._answer(index, packet.payload)
                side = self._sides[index]
                side.send_first(protocol.RELAY_CHANNEL, self._payload(side))
            # last: a program that has the relay's answer then has those of the nodes behind it
            self._presences[index].answer(packet.channel, packet.payload)

    def _pass_announcement(self, index: int, packet: Packet) -> None:
        side, other = self._sides[index], self._sides[1 - index]
        announcement = side.add_announcement(packet)
        if announcement is None or announcement.node.id == self._known.own.id:
            return
        if side.is_news(packet):
            other.forget_routes()
            side.forget_routes()
        if not self._carries or other.has(announcement.node.id):
            return
        size, now = len(packet.payload), time.monotonic_ns()
        passed = self._announced[index].convert(announcement, size, now)
        if passed is not None:
            other.send_first(protocol.NODE_CHANNEL, protocol.encode_announcement(passed))

    def _answer(self, index: int, payload: bytes) -> None:
        """Answer a probe on one bus for the nodes of the other one, or pass it on to one of them.

        Nodes that were announced there within the last second are known here, so that a slow line
        delays no answer.
        """
        probe = protocol.decode_probe(payload)
        if probe is None or not self._carries:
            return
        announced = self._announced[1 - index]
        if probe.target and (target := announced.target(probe.target)) is not None:
            again = protocol.encode_probe(protocol.Probe(target, probe.nonce))
            self._sides[1 - index].send_first(protocol.PROBE_CHANNEL, again)
        if not probe.target:
            self._owes[index] = True
            self._answer_owed(index)

    def _answer_owed(self, index: int) -> None:
        """Announce the nodes of the other bus, if that is owed; no more than half of the time."""
        if not self._owes[index] or time.monotonic() < self._rested[index]:
            return
        self._owes[index], began = False, time.thread_time()
        for announcement in self._announced[1 - index].recent(time.monotonic_ns()):
            payload = protocol.encode_announcement(announcement)
            self._sides[index].send_first(protocol.NODE_CHANNEL, payload)
        self._rested[index] = time.monotonic() + time.thread_time() - began

    def _payload(self, side: Side) -> bytes:
        return encode_report(Report(side.identifier, self._known.links()))

    def _report(self, now: float) -> None:
        self._next_report = now + protocol.PERIOD
        state = State.ACTIVE if self._carries else State.STANDBY
        self._known.update(state, self._states())
        for side in self._sides:
            side.send_first(protocol.RELAY_CHANNEL, self._payload(side))

    def _tell_observed(self, now: float) -> None:
        """Tell each bus, once a second and soon after a change, what is heard on the other one."""
        is_new = any(side.has_new_route for side in self._sides)
        if now < self._next_observed - (protocol.PERIOD - _SOON if is_new else 0.0):
            return
        self._next_observed = now + protocol.PERIOD
        full = tuple(line for side in self._sides for line in side.full_line(now))
        for side, presence in zip(self._sides, reversed(self._presences), strict=True):
            presence.tell(side.observed() if self._carries else (), full)

    def _decide(self, now: float) -> None:
        active, own = self._known.carrying(), self._known.own.id
        self._delay.update(self._known.own, now)
        waits = self._waits(now)
        self._say_awaited(self._delay.awaited(now) if waits else "")
        carries = own in active and not waits
        if carries != self._carries:
            self._change(now, carries=carries)
        if carries != self._has_notified and not waits:  # it is true by now
            self._has_notified = carries
            self._say_state(active)

    def _change(self, now: float, *, carries: bool) -> None:
        """Carry messages from now on, or stand by."""
        self._carries = carries
        if carries:
            for index, side in enumerate(self._sides):
                side.forget_routes()
                self._repeat_latched(index)
                side.send_first(protocol.PROBE_CHANNEL, protocol.encode_probe(protocol.Probe()))
        else:
            for side in self._sides:
                side.queue.clear()  # it would mix with the next relay's messages
        self._report(now)

    def _waits(self, now: float) -> bool:
        return not self._carries and self._delay.lasts(now)

    def _repeat_latched(self, index: int) -> None:
        """Send latched messages again to a bus where they may have been lost."""
        if self._carries:
            self._sides[index].queue.add(self._sides[1 - index].latched())

    def _say_awaited(self, identifier: str) -> None:
        """Notify once if another relay is heard on the other bus, but not yet over this line."""
        if identifier and identifier != self._awaited:
            here, there = self._sides
            line, other = (here, there) if identifier == here.identifier else (there, here)
            problem = f"another relay is on {other.bus}"
            self._notify(f"{problem}; waiting some seconds for its answer on {line.bus}")
        self._awaited = identifier

    def _say_left_out(self) -> None:
        """Notify once of each topic that needs an option of its own to pass, and of the option."""
        for side in self._sides if self._carries else ():
            for topic in side.named_only.keys() - self._said_left_out:
                self._said_left_out.add(topic)
                rest = "" if self._rules.allow else "--allow '**' "
                self._notify(f"leaves out {topic}; to pass it: {rest}--allow {topic}")

    def _say_state(self, active: Collection[str]) -> None:
        here, there = (side.bus for side in self._sides)
        if self._has_notified:
            ways = f"from {here} to" if self._rules.one_way else f"between {here} and"
            self._notify(f"carries messages {ways} {there}")
        elif active and not any(self._troubles):
            names = sorted(one.name for one in self._known.links() if one.id in active)
            self._notify(f"stands by: {', '.join(names)} joins {here} and {there}")

    def _tell_troubles(self, now: float) -> bool:
        """Notify when a bus cannot be reached, or can again; return whether that has changed."""
        changed = False
        for index, side in enumerate(self._sides):
            trouble = side.end.trouble
            if bool(trouble) != bool(self._troubles[index]):
                changed = True
                self._delay.begin(now)
                self._notify(trouble or f"{side.bus} is back")
            self._troubles[index] = trouble
        return changed


def usual_name() -> str:
    """Return the default name of a relay, from its computer's name and its pid."""
    host = "".join(one if one.isalnum() and one.isascii() else "_" for one in socket.gethostname())
    return f"/relay_{host}_{os.getpid()}"


def attend(relay: Relay, on_turn: Callable[[Link], None]) -> NoReturn:
    """Run a relay until an exception ends it; ``on_turn`` gets its state repeatedly.

    Its threads switch more often than in other programs: a message waits for at most one turn of
    the other direction's thread.
    """
    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH)
    try:
        while True:
            on_turn(relay.turn())
    finally:
        sys.setswitchinterval(before)
