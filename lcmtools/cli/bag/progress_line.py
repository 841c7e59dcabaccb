"""The line that shows where a player is."""

from lcmtools.bag.player import Position
from lcmtools.bag.player_keys import KEYS_HELP
from lcmtools.cli.output import talk
from lcmtools.cli.status_line import StatusLine
from lcmtools.terminal import has_keys


class ProgressLine(StatusLine):
    """The line of a player; its arguments are those of ``StatusLine``."""

    def __init__(self, command: str, *, is_quiet: bool) -> None:
        super().__init__(command, is_quiet=is_quiet)
        self._has_helped = not (self.shows and has_keys())

    def show(self, position: Position) -> None:
        """Show where the player is."""
        if not self._has_helped:
            self._has_helped = True
            talk(KEYS_HELP)
        self.write(position_text(position))


def position_text(position: Position) -> str:
    """Return "45.2 / 75.8 s", with the rate where it is not 1."""
    rate = "" if position.rate == 1 else f"  x{position.rate:g}" if position.rate else "  at once"
    paused = "  paused" if position.is_paused else ""
    return f"{position.seconds:.1f} / {position.length:.1f} s{rate}{paused}"
