"""A cable that loses one in N datagrams of each sender to the group: PORT PORT N [LOSES].

It stands between two interfaces of a switch and carries the frames of each to the other. The first
one of a sender is lost, then each N-th. LOSES is the one of both whose frames only are lost.
"""

import select
import socket
import sys
from collections import Counter

ETH_P_ALL = 3
MULTICAST_UDP = 17
FIRST_PIECE = 0x1FFF  # the offset of an IP fragment


def main(one, other, every, loses=""):
    """Forward until killed."""
    sockets = [_open(one), _open(other)]
    opposite = dict(zip(sockets, reversed(sockets), strict=True))
    numbers = Counter()
    sys.stdout.write("forwards\n")
    sys.stdout.flush()
    while True:
        for ready in select.select(sockets, [], [])[0]:
            frame, (port, _, kind, *_) = ready.recvfrom(65536)
            if kind == socket.PACKET_OUTGOING:
                continue
            if loses in ("", port) and _is_lost(frame, numbers, every):
                continue
            opposite[ready].send(_without_checksum(frame))


def _open(interface):
    raw = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    raw.bind((interface, 0))
    return raw


def _is_lost(frame, numbers, every):
    """Return whether it is the first piece of a datagram to be lost: the others are no use then.

    The count is each sender's own: source address and source port.
    """
    if not (_is_udp(frame) and frame[30] >= 224):
        return False
    sender = frame[26:30] + frame[34:36]
    numbers[sender] += 1
    return numbers[sender] % every == 1


def _is_udp(frame):
    """Return whether a UDP header follows an IPv4 header without options."""
    return (
        frame[12:15] == b"\x08\x00\x45"
        and frame[23] == MULTICAST_UDP
        and not int.from_bytes(frame[20:22], "big") & FIRST_PIECE
    )


def _without_checksum(frame):
    """The frame with 0 as UDP's checksum, "none": between virtual interfaces it is not made."""
    return frame[:40] + b"\0\0" + frame[42:] if _is_udp(frame) else frame


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), *sys.argv[4:])
