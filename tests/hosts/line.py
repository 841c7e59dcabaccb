"""A long line between two interfaces of a switch: ONE OTHER DELAY_MS EVERY BYTES_PER_SECOND.

It delays all frames, loses every so-manieth one, and lets no more bytes pass in a second; what
waits for more than half a second's bytes is lost, as in a router's queue. SIGUSR1 cuts it, and
mends it again.
"""

import select
import signal
import socket
import sys
import time
from collections import deque

ETH_P_ALL = 3
QUEUE = 0.5  # [s]


class Way:
    """One direction of the line."""

    def __init__(self, to, delay, every, rate):
        self._to, self._delay, self._every, self._rate = to, delay, every, rate
        self._waiting = deque()
        self._free = 0.0  # time from which the next frame may leave
        self._frames = 0

    def add(self, frame, now):
        """Take a frame."""
        self._frames += 1
        start = max(now, self._free)
        if self._frames % self._every == 0 or start - now > QUEUE:
            return
        self._free = start + len(frame) / self._rate
        self._waiting.append((self._free + self._delay, frame))

    def send(self, now):
        """Send what is due; return the time until the next frame is."""
        while self._waiting and self._waiting[0][0] <= now:
            self._to.send(self._waiting.popleft()[1])
        return self._waiting[0][0] - now if self._waiting else 1.0


def main(one, other, delay_ms, every, rate):
    """Forward until killed."""
    sockets = [_open(one), _open(other)]
    settings = float(delay_ms) / 1e3, int(every), float(rate)
    ways = {a: Way(b, *settings) for a, b in zip(sockets, reversed(sockets), strict=True)}
    cuts = []

    def toggle(*_):
        cuts.clear() if cuts else cuts.append(True)
        _say(f"{'is cut' if cuts else 'is mended'} at {time.monotonic():.3f}")

    signal.signal(signal.SIGUSR1, toggle)
    _say("forwards")
    left = 1.0
    while True:
        for ready in select.select(sockets, [], [], max(0.0, left))[0]:
            frame, (_, _, kind, *_) = ready.recvfrom(65536)
            if kind != socket.PACKET_OUTGOING and not cuts:
                ways[ready].add(frame, time.monotonic())
        left = min(way.send(time.monotonic()) for way in ways.values())


def _say(text):
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def _open(interface):
    raw = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    raw.bind((interface, 0))
    return raw


if __name__ == "__main__":
    main(*sys.argv[1:])
