"""The stamp attached to a message, if the bus allows it: sender, number, time and origin.

Sans-I/O. A stamp has a few bytes, big-endian: the version (1), the sender's id (8), its number of
the message (4), and the time of sending (8) by a clock of the sender's computer [ns], 0 if the
message may be late. For a message from another bus also its id (8) and number (4) there, and the
number of relays (1) that it has passed. Other programs send no stamp and ignore these.
"""

import struct
from typing import NamedTuple

_VERSION = 2
_OWN = struct.Struct(">BQIQ")
_RELAYED = struct.Struct(">BQIQQIB")
_NUMBERS = 0xFFFFFFFF


class Origin(NamedTuple):
    """The original sender of a message, whatever relays it has passed."""

    id: int  # the sender's id, 64 bits
    seqno: int  # the message's sequence number there, 32 bits
    hops: int = 0  # the relays that the message has passed; 0 if it was sent on this bus


class Stamp(NamedTuple):
    """The stamp of a message: the id of its sender on this bus, its number, time and origin."""

    sender: int
    seqno: int
    time: int  # by a clock of the sender's computer [ns]; 0 for a message that may be late
    origin: Origin


def encode_stamp(sender: int, seqno: int, time: int = 0, origin: Origin | None = None) -> bytes:
    """Return the bytes of a stamp; without an origin, the sender itself is the origin."""
    number = seqno & _NUMBERS
    if origin is None:
        return _OWN.pack(_VERSION, sender, number, time)
    first, hops = origin.seqno & _NUMBERS, min(origin.hops, 255)
    return _RELAYED.pack(_VERSION, sender, number, time, origin.id, first, hops)


def decode_stamp(data: bytes) -> Stamp | None:
    """Return the stamp in these bytes; None if they are not a stamp, or of another version."""
    if data[:1] != bytes([_VERSION]):
        return None
    if len(data) == _OWN.size:
        _, sender, seqno, time = _OWN.unpack(data)
        return Stamp(sender, seqno, time, Origin(sender, seqno))
    if len(data) == _RELAYED.size:
        _, sender, seqno, time, first, number, hops = _RELAYED.unpack(data)
        return Stamp(sender, seqno, time, Origin(first, number, hops))
    return None
