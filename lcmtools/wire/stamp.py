"""The stamp attached to a message, if the bus allows it: sender, number, time and origin.

Sans-I/O. A stamp has a few bytes, big-endian: a mark (1), the number of relays (1) that the message
has passed, the sender's id (8), its number of the message (4), and the time of sending (8) by a
clock of the sender's computer [ns], 0 if the message may be late. After a relay, also the original
sender's id (8) and number (4) follow. Later versions may append more, which a reader ignores. Other
programs send no stamp and ignore these.
"""

import struct
from typing import NamedTuple

_MARK = 3  # tells a stamp from attachments of other programs; it never changes
_OWN = struct.Struct(">BBQIQ")
_ORIGIN = struct.Struct(">QI")
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
        return _OWN.pack(_MARK, 0, sender, number, time)
    # a message whose origin is known has passed a relay
    own = _OWN.pack(_MARK, min(max(origin.hops, 1), 255), sender, number, time)
    return own + _ORIGIN.pack(origin.id, origin.seqno & _NUMBERS)


def decode_stamp(data: bytes) -> Stamp | None:
    """Return the stamp that begins these bytes; None if there is none."""
    if data[:1] != bytes([_MARK]) or len(data) < _OWN.size:
        return None
    _, hops, sender, seqno, time = _OWN.unpack_from(data)
    if not hops:
        return Stamp(sender, seqno, time, Origin(sender, seqno))
    if len(data) < _OWN.size + _ORIGIN.size:
        return None
    first, number = _ORIGIN.unpack_from(data, _OWN.size)
    return Stamp(sender, seqno, time, Origin(first, number, hops))
