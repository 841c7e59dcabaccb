"""The stamp beside a message on a bus that takes one: its sender, its number, time and origin.

Sans-I/O. A stamp is of few bytes, big-endian: the version (1), the sender's id (8) and its number
of the message (4), the time of sending (8) by a clock of the sender's computer [ns], 0 if it may be
late; of one that came from another bus also the id (8) and number (4) there, and the number of
relays (1) that it has passed. Other programs send none, and read past ours.
"""

import struct
from typing import NamedTuple

_VERSION = 2
_OWN = struct.Struct(">BQIQ")
_RELAYED = struct.Struct(">BQIQQIB")
_NUMBERS = 0xFFFFFFFF


class Origin(NamedTuple):
    """The first sender of a message, wherever it has come through since."""

    id: int  # the sender's id, of 64 bits
    seqno: int  # its number of the message, of 32 bits
    hops: int = 0  # the relays that the message has passed; 0 where it was sent to this bus


class Stamp(NamedTuple):
    """The stamp of a message: the id of who sent it to this bus, its number, time and origin."""

    sender: int
    seqno: int
    time: int  # [ns] of a clock of the sender's computer; 0 for a message that may be late
    origin: Origin


def encode_stamp(sender: int, seqno: int, time: int = 0, origin: Origin | None = None) -> bytes:
    """Return the bytes of a stamp; without an origin, of a message of the sender itself."""
    number = seqno & _NUMBERS
    if origin is None:
        return _OWN.pack(_VERSION, sender, number, time)
    first, hops = origin.seqno & _NUMBERS, min(origin.hops, 255)
    return _RELAYED.pack(_VERSION, sender, number, time, origin.id, first, hops)


def decode_stamp(data: bytes) -> Stamp | None:
    """Return the stamp in these bytes; None if they are none, or of another version."""
    if data[:1] != bytes([_VERSION]):
        return None
    if len(data) == _OWN.size:
        _, sender, seqno, time = _OWN.unpack(data)
        return Stamp(sender, seqno, time, Origin(sender, seqno))
    if len(data) == _RELAYED.size:
        _, sender, seqno, time, first, number, hops = _RELAYED.unpack(data)
        return Stamp(sender, seqno, time, Origin(first, number, hops))
    return None
