"""A message as it arrived from the bus, before its type is known.

These are created, hashed and compared for every observed message, so they are named tuples: frozen
dataclasses take three times as long to create, and Python code to hash.
"""

from typing import NamedTuple, TypeAlias

from lcmtools.wire.stamp import Origin


class Sender(NamedTuple):
    """The source of a datagram: each LCM instance sends from its own UDP port."""

    address: str  # IPv4 address ("127.0.0.1"); on Zenoh, the id of a session in 16 hex digits
    port: int  # UDP port; 0 on Zenoh
    # Its name when it was recorded; "" on a bus. This tells a sender in a log from a running
    # program that has the same address.
    name: str = ""

    @property
    def computer(self) -> str:
        """The address of its computer: on Zenoh, the computer's part of the session's id."""
        return self.address if self.port or self.name else self.address[:8]

    def __str__(self) -> str:
        """Return its name, else address and port, as ss and netstat print them."""
        return self.name or (f"{self.address}:{self.port}" if self.port else self.address)


Datagram: TypeAlias = tuple[bytes, Sender, int, int | None]
"""A datagram: its bytes, its source, its arrival [ns since 1970], and its time to live if known."""


class Packet(NamedTuple):
    """One message on a channel."""

    channel: str  # the channel's name
    payload: bytes  # fingerprint and encoded struct, or any other bytes
    time: int  # time of arrival [ns since 1970], from the kernel if known
    # Its sender; None if the bus does not identify it (tcpq, memq, logs without an index).
    sender: Sender | None = None
    seqno: int | None = None  # its sequence number, given by its sender; None for none
    # Bytes of the whole payload if ``payload`` is only its beginning; else None.
    whole_bytes: int | None = None
    # Its original sender, before any relay; None if the bus does not identify it.
    origin: Origin | None = None
    # The type that its sender attached to it ("geometry_msgs/Twist"); "" for none.
    type_name: str = ""

    @property
    def size(self) -> int:
        """Bytes of the whole payload."""
        return len(self.payload) if self.whole_bytes is None else self.whole_bytes

    @property
    def fingerprint(self) -> int | None:
        """The type's fingerprint (unsigned); None if the payload is too short to have one."""
        if len(self.payload) < 8:  # noqa: PLR2004 - a fingerprint has 8 bytes
            return None
        return int.from_bytes(self.payload[:8], "big")
