"""``lcmtools bag play``."""

import math
from collections.abc import Callable

from lcmtools.bag import stamps
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.play import Manner, play
from lcmtools.bag.player import KEYS_HELP, Position
from lcmtools.bag.playlist import Choice
from lcmtools.bag.times import LogTime
from lcmtools.cli.bag.common import (
    exclude_option,
    not_negative,
    refuse_no_files,
    stamp_option,
    topics_option,
    values_options,
    window_options,
)
from lcmtools.cli.bus import chosen_url
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import bus_choice, bus_options, names_options
from lcmtools.cli.output import write_note
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError
from lcmtools.terminal import has_keys
from lcmtools.text_table import plural

_rate = not_negative("the rate must be positive, or 0 for as fast as possible")


@subcommand("play", names_options, bus_options)
@examples(
    "bag play ride.lcmlog",
    "bag play ride.lcmlog --ns /replay --rate 2 --start 1m",
    "bag play ride.lcmlog -t '/husky0/**' -x /husky0/cmd_vel --clock",
    "bag play front.lcmlog rear.lcmlog --start end-30s --loop",
    "bag play odometry.csv --type nav_msgs/Odometry --as /odometry",
)
@argument("files", nargs=-1, required=True, metavar="FILE...", completer="files")
@option(
    "-r",
    "--rate",
    metavar="RATE",
    type=_rate,
    default=1.0,
    help="Speed: 2 is twice as fast, 0 at once.",
)
@window_options
@option("-u", "--duration", type=duration, help="Play at most this much of the log.")
@flag("-l", "--loop", "loops", help="Start again at the end.")
@topics_option
@exclude_option
@stamp_option
@values_options
@flag("--clock", help="Publish the log's time on /clock, for nodes on simulated time.")
@flag(
    "-w",
    "--wait-subscribers",
    "--wait-for-subscribers",
    "waits",
    help="Wait until a node subscribes to each topic; plain LCM programs do not count.",
)
@option(
    "--max-gap",
    "most_gap",
    type=duration,
    help="Skip longer times without messages.",
)
@flag("-p", "--pause", "is_paused", help="Start paused.")
@flag("--force", help="Play even if another program publishes, or a robot would obey.")
@flag("-q", "--quiet", help="Show no progress.")
def command(
    files: tuple[str, ...],
    *,
    rate: float,
    start: LogTime | None,
    end: LogTime | None,
    duration: float | None,
    loops: bool,
    wanted: tuple[str, ...],
    excluded: tuple[str, ...],
    by_stamp: bool,
    type_: str | None,
    topic: str | None,
    clock: bool,
    waits: bool,
    most_gap: float | None,
    is_paused: bool,
    force: bool,
    quiet: bool,
) -> None:
    """Publish the messages of logs again, with their original timing.

    Several logs are merged by time; JSON lines and values, as bag export writes them, are logs,
    too. Payloads are sent as they are. --ns /replay puts all topics below /replay, A:=B plays topic
    A on B. A time is 10s (after the start of the log), end-1m, 12:30:05 or '2026-11-22 12:30:05'.
    Recorded announcements of nodes are never played, and other hidden topics only if they are
    named.

    Nothing is played if another program publishes on one of the topics, or if a robot would obey
    one: a node that subscribes to commands, or a simulator. --force plays anyway; at a pause and at
    the end it then sends zero if the last command was a velocity or an effort.

    Keys: SPACE pauses and resumes, . or s plays one message, n skips to the next one, left and
    right seek 5 s, [ and ] a minute, up and down double and halve the rate, 0 to 9 jump to that
    tenth of the log, q ends.
    """
    if is_paused and not has_keys():
        raise UsageError("--pause needs a terminal, because only a key resumes", "leave it out")
    refuse_no_files(files, wanted)
    topics = TopicChoice(wanted, excluded)
    choice = Choice(topics=topics, names=bus_choice().names, keeps_clock=clock)
    manner = Manner(
        rate=rate,
        start=start,
        end=end,
        duration=duration,
        loops=loops,
        is_paused=is_paused,
        clock=clock,
        waits=waits,
        most_gap=math.inf if most_gap is None else most_gap,
        typed=(*files, *["--by-stamp"] * by_stamp),
        force=force,
    )
    with (
        StatusLine("lcmtools bag play", is_quiet=quiet) as line,
        stamps.by_stamp(files, type_, topic, wanted=by_stamp) as paths,
    ):
        show = _position_shower(line)
        result = play(paths, chosen_url(), choice, manner, notify=line.write_note, on_position=show)
        line.write_note_unless_quiet(
            f"{plural(result.messages, 'message')} in {result.seconds:.1f} s"
        )


def _position_shower(line: StatusLine) -> Callable[[Position], None]:
    """Return a function that shows the player's position. Its first call also shows the keys."""
    untold = [KEYS_HELP] if line.shows and has_keys() else []

    def show(position: Position) -> None:
        if untold:
            write_note(untold.pop())
        line.write(_position_text(position))

    return show


def _position_text(position: Position) -> str:
    """Return "45.2 / 75.8 s", with the rate unless it is 1."""
    rate = "" if position.rate == 1 else f"  x{position.rate:g}" if position.rate else "  at once"
    paused = "  paused" if position.is_paused else ""
    return f"{position.seconds:.1f} / {position.length:.1f} s{rate}{paused}"
