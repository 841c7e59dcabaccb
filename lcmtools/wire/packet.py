"""A message as it came over the bus, before its type is known.

These are made, hashed and compared for every observed message, so they are named tuples: frozen
dataclasses take three times as long to make, and Python code to hash.
"""

from typing import NamedTuple, TypeAlias

from lcmtools.wire.stamp import Origin


class Sender(NamedTuple):
    """The source of a datagram: an LCM instance sends from a UDP port of its own."""

    address: str  # IPv4 address ("127.0.0.1"); on Zenoh, the id of a session in 16 hex digits
    port: int  # UDP port; 0 on Zenoh
    # Its name when it was recorded; "" on a bus. One of a log that has the address of a program
    # that runs now is another one.
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
    time: int  # its arrival, nanoseconds since 1970; by the kernel where that is known
    # Its sender; None where the bus names none (tcpq, memq, logs without an index).
    sender: Sender | None = None
    seqno: int | None = None  # the sender's number of the message; None where there is none
    # Bytes of the whole payload if ``payload`` is only its beginning; else None.
    whole_bytes: int | None = None
    # Its first sender, before any relay; None where the bus names none.
    origin: Origin | None = None
    # The type that its sender names beside it ("geometry_msgs/Twist"); "" for none.
    type_name: str = ""

    @property
    def size(self) -> int:
        """Bytes of the whole payload."""
        return len(self.payload) if self.whole_bytes is None else self.whole_bytes

    @property
    def fingerprint(self) -> int | None:
        """The type's fingerprint (unsigned); None when the payload is too short to have one."""
        if len(self.payload) < 8:  # noqa: PLR2004 - a fingerprint has 8 bytes
            return None
        return int.from_bytes(self.payload[:8], "big")
