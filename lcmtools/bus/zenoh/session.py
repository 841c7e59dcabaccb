"""A Zenoh session and its pitfalls. Only ``bus.zenoh.opening`` imports Zenoh's package.

- A message to a program that does not read waits; after a second, Zenoh disconnects that program,
  which reconnects when it reads again.
- A process that ends without closing its session can hang: it is closed at exit. A forked process
  can do nothing with Zenoh: it leaves its parent's session alone, and cannot open another.
- After an interruption, a connection resumes: messages that waited for it are dropped on arrival.
- Messages still under way when a session closes are lost: closing waits until the others have them.
- Callbacks run on Zenoh's own threads, which must not wait: messages are queued at once.
- Replies with the same key are merged unless that is switched off.
"""

import atexit
import contextlib
import ctypes
import functools
import os
import threading
import time
import weakref
from collections import Counter, deque
from collections.abc import Callable

from lcmtools.bus.base import outage_texts
from lcmtools.bus.kernel import computer_id
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.bus.zenoh.config import is_own
from lcmtools.bus.zenoh.keep_last_sender import CLOCK
from lcmtools.bus.zenoh.late_messages import LateMessages, tell_time
from lcmtools.bus.zenoh.opening import direct, open_session, reason_of, zenoh
from lcmtools.bus.zenoh.sender import ZenohSender
from lcmtools.errors import BusError
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    PROTOCOL_CHANNELS,
    Retained,
    decode_probe,
)
from lcmtools.messages.registry import candidates
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.reader import PROTOCOL_PREFIX
from lcmtools.wire.stamp import Origin, decode_stamp, encode_stamp

_MOST_WAITING = 10_000  # messages
_MOST_WAITING_BYTES = 64 << 20
_ANSWER_TIMEOUT = 1.0  # [s]
_FLUSH_TIMEOUT = 1.0  # [s]
_CLOSE_TIMEOUT, _LISTENING_TIMEOUT = 2.0, 0.3  # [s]; the latter if there is an address to listen at
_RECEIVED = f"{PROTOCOL_PREFIX}received"  # the key of a query that needs no reply, only to end


class ZenohSession:
    """A connection to a Zenoh bus, from which one thread receives.

    ``on_outage`` is called by ``receive`` when the connection to a router is lost or restored, with
    a text and the current problem, "" for none.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
        MissingExtra: Zenoh is not installed.
    """

    def __init__(self, url: BusUrl, on_outage: Callable[[str, str], None]) -> None:
        self._url, self._place = url, url.place
        self._on_outage = on_outage
        self._outages: deque[bool] = deque()  # True for one that began, False for one that ended
        self._keys = self._place.keys
        # The session's id, 64 bits: the computer's number, then a random one.
        self.id = computer_id() << 32 | int.from_bytes(os.urandom(4), "big")
        self.dropped = 0  # messages that came late, or the oldest if they were not received in time
        self._arrived: deque[tuple[zenoh.Sample, int, int, bool]] = deque()
        self._bytes = 0
        # For Zenoh's threads, one for each connection, and signal handlers that publish.
        self._counting = threading.RLock()
        self._answers = 0  # pending requests
        self._answered: set[str] = set()  # the sessions that answered the last one
        self._retained = Retained()
        self._subscribers: dict[str, list[zenoh.Subscriber[None]]] = {}
        self._session, is_client = open_session(url, self.id)
        self.sender = ZenohSender(self._session, self.id)
        self._wakeup = WakeupEvent()
        atexit.register(self.close)
        own = weakref.ref(self)
        os.register_at_fork(after_in_child=lambda: _leave_to_parent(own()))
        if is_client:
            self._session.info.declare_transport_events_listener(direct(self._note_outage))
        nodes = self._keys.key(NODE_CHANNEL)
        self._queryable = self._session.declare_queryable(nodes, direct(self._answer))
        received = self._keys.key(_RECEIVED)
        self._late = LateMessages(self._session, received)
        told = functools.partial(tell_time, sender=self.id)
        self._barrier = self._session.declare_queryable(received, direct(told))

    def fileno(self) -> int:
        """Return the descriptor, which is readable while messages wait."""
        return self._wakeup.fileno()

    @property
    def is_awaiting(self) -> bool:
        """True while answers to a probe may still come; ask sessions found since the last one."""
        own = filter(is_own, map(str, self._session.info.peers_zid()))
        if not self._answers and not self._answered.issuperset(own):
            self._ask()
        return self._answers > 0

    @property
    def has_strangers(self) -> bool:
        """True if it is connected with a router, or with programs that are not lcmtools'."""
        info = self._session.info
        return any(not is_own(str(zid)) for zid in (*info.peers_zid(), *info.routers_zid()))

    def dropped_of(self) -> Counter[str]:
        """Return the number of messages of each channel that were not sent in time."""
        found: Counter[str] = Counter()
        for key, number in self.sender.dropped_of().items():
            if named := self._keys.named(key):
                found[named.channel] += number
        return found

    def publish(
        self,
        channel: str,
        payload: bytes,
        type_name: str = "",
        origin: Origin | None = None,
        *,
        latched: bool = False,
    ) -> None:
        """Send one message; see ``Bus.publish``. BusError if the session is closed."""
        if channel == NODE_CHANNEL:
            self._retained.keep(payload, time.monotonic())
        elif channel == PROBE_CHANNEL and (probe := decode_probe(payload)) and not probe.target:
            self._ask()
        if self._keys.is_typed and not type_name:
            names = candidates(int.from_bytes(payload[:8], "big"))
            type_name = names[0] if len(names) == 1 else ""
        key = self._keys.key(channel, type_name)
        try:
            self.sender.send(channel, key, payload, origin, may_be_late=latched)
        except zenoh.ZError as error:
            raise BusError(f"cannot publish on {channel}: {reason_of(error)}") from error

    def subscribe(self, channel: str | None) -> None:
        """Receive a channel's messages from now on; for None, those of all channels."""
        patterns = (self._keys.all,) if channel is None else self._keys.patterns(channel)
        declare = self._session.declare_subscriber
        found = [declare(pattern, direct(self._arrive)) for pattern in patterns]
        self._subscribers[channel or ""] = found

    def unsubscribe(self, channel: str) -> None:
        """Undo ``subscribe``."""
        for subscriber in self._subscribers.pop(channel, ()):
            with contextlib.suppress(zenoh.ZError):
                subscriber.undeclare()  # type: ignore[no-untyped-call] # untyped in the package

    def receive(self, most: int = _MOST_WAITING) -> list[Packet]:
        """Return the messages that have arrived, ``most`` at most, without waiting."""
        self._wakeup.clear()
        while self._outages:
            self._on_outage(*outage_texts(self._url, is_lost=self._outages.popleft()))
        with self._counting:
            received = [self._arrived.popleft() for _ in range(min(most, len(self._arrived)))]
            self._bytes -= sum(len(sample.payload) for sample, *_ in received)
        if self._arrived:
            self._wakeup.set()
        return [packet for one in received if (packet := self._packet(*one))]

    def close(self) -> None:
        """Send waiting messages, and leave the bus."""
        atexit.unregister(self.close)
        self.sender.close()
        self._await_receivers()
        closing = threading.Thread(target=self._close_session, name="zenoh close", daemon=True)
        closing.start()
        # Zenoh goes on for ten seconds with waiting for an address that another program uses, or
        # for one at the other end of a line that is full
        closing.join(_LISTENING_TIMEOUT if self._place.listen else _CLOSE_TIMEOUT)
        self.sender.close()  # its threads must not be in Zenoh's code when Python ends
        self._wakeup.close()

    def _close_session(self) -> None:
        with contextlib.suppress(zenoh.ZError):
            for queryable in (self._queryable, self._barrier):
                queryable.undeclare()  # type: ignore[no-untyped-call]
            self._session.close()  # type: ignore[no-untyped-call]

    def _await_receivers(self) -> None:
        """Wait until other sessions have received what was sent: closing would discard it.

        The query follows the messages, of which large ones leave last.
        """
        answered = threading.Event()
        handler = zenoh.handlers.Callback(_ignore, answered.set, indirect=False)
        with contextlib.suppress(zenoh.ZError):
            self._session.get(
                *(self._keys.key(_RECEIVED), handler),
                target=zenoh.QueryTarget.ALL,
                priority=zenoh.Priority.DATA_LOW,
                congestion_control=zenoh.CongestionControl.BLOCK,
                timeout=_FLUSH_TIMEOUT,
            )
            answered.wait(_FLUSH_TIMEOUT)

    def _note_outage(self, event: zenoh.TransportEvent) -> None:
        self._outages.append(event.kind == zenoh.SampleKind.DELETE)
        self._wakeup.set()

    def _ask(self) -> None:
        """Request the announcements that other sessions keep, which arrive at once."""
        self._answered.clear()
        self._answers += 1
        self._session.get(
            self._keys.key(NODE_CHANNEL),
            zenoh.handlers.Callback(self._on_reply, self._end_answer, indirect=False),
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=_ANSWER_TIMEOUT,
        )

    def _on_reply(self, reply: zenoh.Reply) -> None:
        if reply.replier_id is not None:
            self._answered.add(str(reply.replier_id.zid))
        if reply.ok is not None:
            self._arrive(reply.ok, is_reply=True)

    def _end_answer(self) -> None:
        self._answers -= 1
        self._wakeup.set()

    def _answer(self, query: zenoh.Query) -> None:
        """Reply with the announcements of this session's nodes to a session that came later."""
        query.reply_err(b"")  # a reply even if there are none
        stamp = encode_stamp(self.id, 0, time.clock_gettime_ns(CLOCK))
        for payload in self._retained.payloads(time.monotonic()):
            query.reply(query.key_expr, payload, attachment=stamp)

    def _arrive(self, sample: zenoh.Sample, *, is_reply: bool = False) -> None:
        """Queue a message, on a Zenoh thread; drop the oldest if there is no room."""
        arrived = sample, time.time_ns(), time.clock_gettime_ns(CLOCK), is_reply
        with self._counting:
            self._arrived.append(arrived)
            self._bytes += len(sample.payload)
            while len(self._arrived) > 1 and (
                len(self._arrived) > _MOST_WAITING or self._bytes > _MOST_WAITING_BYTES
            ):
                oldest, *_ = self._arrived.popleft()
                self._bytes -= len(oldest.payload)
                self.dropped += 1
        self._wakeup.set()

    def _packet(
        self,
        sample: zenoh.Sample,
        arrival: int,
        clock: int,
        is_reply: bool,  # noqa: FBT001
    ) -> Packet | None:
        payload = sample.payload.to_bytes()
        named = self._keys.named(str(sample.key_expr))
        if named is None:
            return None
        attachment = sample.attachment
        stamp = decode_stamp(attachment.to_bytes()) if attachment is not None else None
        if stamp is None:
            return Packet(named.channel, payload, arrival, type_name=named.type_name)
        if self._late.is_late(stamp, clock) and named.channel not in PROTOCOL_CHANNELS:
            self.dropped += 1
            return None
        sender = Sender(f"{stamp.sender:016x}", 0)
        known = named.channel, payload, arrival, sender, None if is_reply else stamp.seqno
        return Packet(*known, origin=stamp.origin, type_name=named.type_name)


def _leave_to_parent(session: ZenohSession | None) -> None:
    """Never close or free a parent's session in a forked process: that would hang."""
    if session is not None:
        atexit.unregister(session.close)
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(session))


def _ignore(_: object) -> None:
    """Do nothing: a query ends without a reply, and a reply is not needed."""
