"""The player of a log: when each message is due, given rate, pauses, seeks and keys.

Pure: the time comes in as an argument, in nanoseconds of a monotonic clock.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from lcmtools.bag.playlist import Played
from lcmtools.clock import NANOSECONDS
from lcmtools.terminal import DOWN, ESCAPE, LEFT, RIGHT, UP

MOST_BEHIND = NANOSECONDS // 10
"""A delay up to this [ns] is made up for; a longer one postpones the rest, so that a computer that
slept sends no burst."""
_SLOWEST, _FASTEST = 1 / 64, 64.0

Source = Callable[[int, int], Iterator[Played]]
"""Returns the messages between two times in the log, both included [ns since 1970]."""


class Position(NamedTuple):
    """The position of a player."""

    seconds: float  # since the start of the played part
    length: float  # of the played part [s]
    rate: float  # 0 for as fast as possible
    is_paused: bool


class Player:
    """The schedule of a log's messages, those between the times of ``window`` [ns since 1970].

    Every message is due by its time in the log and by when playing began, paused or changed its
    rate, so that delays do not add up.
    """

    def __init__(
        self,
        messages: Source,
        window: tuple[int, int],
        *,
        rate: float = 1.0,
        loops: bool = False,
        is_paused: bool = False,
        now: int = 0,
    ) -> None:
        self._source, self._window, self._loops = messages, window, loops
        self.rate = rate  # seconds of the log per second; 0 for as fast as possible
        self.is_paused = is_paused  # True if paused: nothing is due
        self.is_over = False  # True if there are no more messages
        self._log_time, self._begin = window[0], now
        self._next: Played | None = None
        self._move(window[0], now)

    def pop_due(self, now: int) -> Played | None:
        """Return the next message if it is due; else None."""
        message = self._next
        if message is None or self.is_paused:
            return None
        late = now - self._due(message)
        if late < 0:
            return None
        if not self.rate:
            self._log_time = message.time
        elif late > MOST_BEHIND:
            self._begin += late
        self._advance(message, now)
        return message

    def step(self, now: int) -> Played | None:
        """Pause, and return the next message whether or not it is due."""
        self.pause(now)
        message = self._next
        if message is not None:
            self._log_time = message.time
            self._advance(message, now)
        return message

    def skip(self, now: int) -> None:
        """Let the next message be due, as if the time before it had passed; not in a pause."""
        if self._next is not None and not self.is_paused:
            self._log_time, self._begin = self._next.time, now

    def wait(self, now: int) -> float:
        """Return the time until the next message is due [s]; infinite in a pause."""
        if self._next is None or self.is_paused:
            return float("inf")
        return max(0.0, (self._due(self._next) - now) / NANOSECONDS)

    def time(self, now: int) -> int:
        """Return the time in the log [ns since 1970]."""
        if self.is_paused or not self.rate:
            return self._log_time
        played = self._log_time + round((now - self._begin) * self.rate)
        return min(played, self._window[1])

    def position(self, now: int) -> Position:
        """Return the player's position."""
        start, end = self._window
        seconds, length = (self.time(now) - start) / NANOSECONDS, (end - start) / NANOSECONDS
        return Position(seconds, length, self.rate, self.is_paused)

    def pause(self, now: int) -> None:
        """Pause; does nothing in a pause."""
        self._hold(now)
        self.is_paused = True

    def resume(self, now: int) -> None:
        """Continue from where the pause began."""
        self._begin, self.is_paused = now, False

    def postpone(self, delay: int) -> None:
        """Continue as if this time [ns] had not passed."""
        self._begin += delay

    def set_rate(self, rate: float, now: int) -> None:
        """Change the rate, within 1/64 and 64; 0 is as fast as possible."""
        self._hold(now)
        self.rate = min(max(rate, _SLOWEST), _FASTEST) if rate else 0.0

    def seek(self, time: int, now: int) -> None:
        """Continue from a time in the log [ns since 1970]; after the last message it is over."""
        start, end = self._window
        self._move(min(max(time, start), end), now)
        if self.is_over and self._loops:
            self._move(start, now)

    def seek_by(self, seconds: float, now: int) -> None:
        """Go forward or back in the log."""
        self.seek(self.time(now) + round(seconds * NANOSECONDS), now)

    def seek_part(self, part: float, now: int) -> None:
        """Continue from a fraction of the played part, 0 to 1."""
        start, end = self._window
        self.seek(start + round((end - start) * part), now)

    def _due(self, message: Played) -> int:
        if not self.rate:
            return self._begin
        return self._begin + round((message.time - self._log_time) / self.rate)

    def _hold(self, now: int) -> None:
        self._log_time, self._begin = self.time(now), now

    def _move(self, time: int, now: int) -> None:
        self._log_time, self._begin = time, now
        self._messages = self._source(time, self._window[1])
        self._next = next(self._messages, None)
        self.is_over = self._next is None

    def _advance(self, message: Played, now: int) -> None:
        self._next = next(self._messages, None)
        self.is_over = self._next is None
        if self.is_over and self._loops:
            self._move(self._window[0], now if self.is_paused else self._due(message))


KEYS_HELP = (
    "SPACE pause, . one message, n next after a gap, "
    "left/right 5 s, [ ] 1 min, up/down rate, 0-9 place, q end"
)
_SEEKS = {LEFT: -5.0, RIGHT: 5.0, "[": -60.0, "]": 60.0}  # [s] of the log
_FACTORS = {UP: 2.0, DOWN: 0.5}


def press(player: Player, key: str, now: int) -> tuple[bool, Played | None]:
    """Execute a key; return False for the end, and a message that must be sent."""
    if key in ("q", ESCAPE):
        return False, None
    if key in (".", "s"):
        return True, player.step(now)
    if key == " ":
        player.resume(now) if player.is_paused else player.pause(now)
    elif key == "n":
        player.skip(now)
    elif key in _SEEKS:
        player.seek_by(_SEEKS[key], now)
    elif key in _FACTORS:
        player.set_rate((player.rate or 1.0) * _FACTORS[key], now)
    elif key.isascii() and key.isdigit():
        player.seek_part(int(key) / 10, now)
    return True, None
