"""The keys of a player."""

from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Played
from lcmtools.terminal import DOWN, ESCAPE, LEFT, RIGHT, UP

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
