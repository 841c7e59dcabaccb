"""Commands to actuators among the played topics: who would obey them, and the last ones.

Pure decisions on the graph and on messages. A command is recognized by its type (a velocity, an
effort, a trajectory), by its topic's name (cmd_vel, WHEEL_COMMAND, goal) or by its subscriber: a
simulator obeys what it subscribes to. Programs that are not nodes do not show what they subscribe
to.
"""

from collections.abc import Iterable, Sequence
from shlex import quote
from typing import NamedTuple

from lcmtools.bag.playlist import Track
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import message_class
from lcmtools.observe.actuators import is_command_topic
from lcmtools.observe.reports.describe import node_text, program_texts
from lcmtools.publish.standing_command import StandingCommand, obeying, standing_command

_SHARED = "/rosout"  # shared by all nodes: each line has its node's name
_MOST_LINES = 2  # programs that are named as reasons
_MOST_NAMES = 3  # topics of each
_MOST_LEFT_OUT = 2  # topics that a command line leaves out one by one


class Conflict(NamedTuple):
    """A reason not to play a topic: a program that publishes it too, or that would obey it."""

    topic: str
    channel: str  # its name in the log
    program: str  # "/robot (laptop, pid 12)"
    obeys: bool

    @property
    def reason(self) -> str:
        """The reason, as a sentence."""
        verb = "commands" if self.obeys else "is published by"
        return f"{self.topic} {verb} {self.program}"


def is_command(track: Track) -> bool:
    """Return whether a topic's type or name says that its messages are commands."""
    return is_command_topic(track.topic, track.type)


def conflicts(graph: Graph, tracks: Iterable[Track], own: str = "") -> list[Conflict]:
    """Return the reasons not to play topics on a bus: nodes that publish on them or obey them.

    The player's own node, named ``own``, does not count.
    """
    found = []
    for track in tracks:
        where = graph.topic(track.topic)
        live = [node for node, _ in where.publishers if not node.stale and node.name != own]
        publishers = [*map(node_text, live), *program_texts(where.foreign)]
        if track.topic == _SHARED:
            publishers = []
        by_program = [(who, False) for who in publishers]
        by_program += [(node_text(node), True) for node in obeying(graph, track.topic, track.type)]
        found += [Conflict(track.topic, track.channel, *one) for one in dict.fromkeys(by_program)]
    return found


def reasons(found: Iterable[Conflict]) -> list[str]:
    """Return a line or two about conflicts, those of robots that would obey first."""
    topics: dict[tuple[bool, str], list[str]] = {}
    for one in sorted(found, key=lambda one: not one.obeys):
        topics.setdefault((one.obeys, one.program), []).append(one.topic)
    lines = [
        f"{program} {'would obey' if obeys else 'publishes'} {_listed(names)}"
        for (obeys, program), names in topics.items()
    ]
    return [*lines[:_MOST_LINES], "other programs use topics of the log, too"][: len(lines)]


def way_out(found: Iterable[Conflict], tracks: Sequence[Track]) -> str:
    """Return the options with which a log is played without conflicts."""
    channels = dict.fromkeys(one.channel for one in found)
    if len(channels) > _MOST_LEFT_OUT or len(channels) == len(tracks):
        return "--ns /replay"
    return " ".join(f"-x {quote(channel)}" for channel in channels)


def _listed(names: Sequence[str]) -> str:
    """Return "/a, /b, /c and 5 more"."""
    more = len(names) - _MOST_NAMES
    return ", ".join(names[:_MOST_NAMES]) + (f" and {more} more" if more > 0 else "")


class LastCommands:
    """The last command of each topic that was played."""

    def __init__(self, tracks: Iterable[Track]) -> None:
        self._tracks = {track.topic: track for track in tracks}
        self._last: dict[str, bytes] = {}

    def add(self, topic: str, payload: bytes) -> None:
        """Note a message that was published."""
        self._last[topic] = payload

    def pop(self, graph: Graph, *, heard: bool) -> list[StandingCommand]:
        """Return the commands that are still in effect and would be obeyed, then forget them.

        If others are ``heard``, programs that are not nodes may listen too.
        """
        tracks = [self._tracks[topic] for topic in self._last]
        obeyed = [
            one
            for one in tracks
            if obeying(graph, one.topic, one.type) or (heard and is_command(one))
        ]
        found = [_standing(track, self._last.pop(track.topic)) for track in obeyed]
        return [one for one in found if one.values]


def _standing(track: Track, payload: bytes) -> StandingCommand:
    try:
        message = decode(message_class(track.type, track.fingerprint), payload)
    except LcmtoolsError:
        return StandingCommand(track.topic, "of a type that is not known here")
    return standing_command(track.topic, track.type, message)
