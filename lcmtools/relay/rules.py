"""The rules for which topics a relay passes on, under which names and how often. Pure.

Patterns and names are those of the first bus ("here"), also for messages from the second one
("there"). Commands to actuators, /clock and LCM's own channels pass only if ``allow`` has their
exact name: a pattern that happens to match must not drive a robot.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import InvalidName, UsageError
from lcmtools.names import Pattern, check_length, has_wildcard, is_hidden, spellings
from lcmtools.observe.actuators import is_command_topic

_OF_SERVICE = ("/_request", "/_reply")
_NAMED_ONLY = (CLOCK_TOPIC,)
INTERNAL = ("LCM_SELF_TEST", "#!mpudpm")


class Reason(Enum):
    """The reason why a topic does not pass."""

    DENIED = "denied"
    NOT_ALLOWED = "not allowed"
    COMMAND = "a command, which passes only if --allow names it"
    NAMED_ONLY = "passes only if --allow names it"
    TOO_LONG = "its name there would be too long for LCM"
    ELSEWHERE = "not below the prefix"
    ONE_WAY = "against the direction"


class Words:
    """Names and patterns of topics."""

    def __init__(self, words: Sequence[str]) -> None:
        named = [word for word in words if not has_wildcard(word)]
        self._names = {spelling for word in named for spelling in spellings(word)}
        self._patterns = [Pattern(word, hidden=True) for word in words if has_wildcard(word)]

    def name(self, topic: str) -> bool:
        """Return whether one is the topic's exact name."""
        return topic in self._names

    def match(self, topic: str) -> bool:
        """Return whether one matches the topic."""
        return topic in self._names or any(one.matches(topic) for one in self._patterns)


@dataclass(frozen=True, slots=True)
class Rules:
    """The rules of a relay."""

    allow: Sequence[str] = ()  # what passes; empty for everything
    deny: Sequence[str] = ()  # exceptions, which do not pass
    # The most messages of a topic per second, by pattern.
    rates: Mapping[str, float] = field(default_factory=dict)
    newest: Sequence[str] = ()  # topics of which only the newest message waits for the line
    prefix: str = ""  # the namespace there of topics from here; "" for none
    one_way: bool = False  # messages go from here to there only


@dataclass(frozen=True, slots=True)
class Route:
    """A topic's route: its name on the other bus, or the reason why it does not pass."""

    name: str = ""
    reason: Reason | None = None
    period: float = 0.0  # the least time between two messages [s]
    newest: bool = False  # only the newest message waits
    latched: bool = False  # its messages are state, which may be late


class Direction:
    """The rules for one direction: from here to there, or back."""

    def __init__(self, rules: Rules, *, back: bool) -> None:
        self._rules, self._back = rules, back
        self._allow, self._deny = Words(rules.allow), Words(rules.deny)
        self._newest = Words(rules.newest)
        self._rates = [(Words([word]), 1.0 / rate) for word, rate in rules.rates.items()]

    def route(self, channel: str, types: Collection[str], *, obeyed: bool = False) -> Route:
        """Return the route for messages on a channel of the bus that they come from.

        They may have several types. With ``obeyed``, a simulator on the other bus obeys them.
        """
        name = self.name(channel)
        if isinstance(name, Reason):
            return Route(reason=name)
        topic = _topic(name if self._back else channel)
        if self._rules.one_way and self._back:
            return Route(reason=Reason.ONE_WAY)
        if reason := self._reason(topic, channel, types, obeyed=obeyed):
            return Route(reason=reason)
        period = max((period for words, period in self._rates if words.match(topic)), default=0.0)
        return Route(name, None, period, self._newest.match(topic))

    def name(self, channel: str) -> str | Reason:
        """Return a channel's name on the other bus; else the reason why it has none there."""
        prefix = self._rules.prefix
        if not prefix:
            return channel
        if not self._back:
            name = f"/{prefix}{channel}" if channel.startswith("/") else f"{prefix}/{channel}"
            try:
                return check_length(name)
            except InvalidName:
                return Reason.TOO_LONG
        for start, root in ((f"/{prefix}/", "/"), (f"{prefix}/", "")):
            if channel.startswith(start) and len(channel) > len(start):
                return root + channel[len(start) :]
        return Reason.ELSEWHERE

    def typed_name(self, channel: str) -> str:
        """Return the name in the options of a channel of the bus that the rules are for."""
        name = self.name(channel) if self._back else channel
        return channel if isinstance(name, Reason) else name

    def _reason(
        self, topic: str, channel: str, types: Collection[str], *, obeyed: bool
    ) -> Reason | None:
        if self._deny.match(topic):
            return Reason.DENIED
        if self._allow.name(topic):
            return None
        if self._rules.allow and not self._allow.match(topic):
            return Reason.NOT_ALLOWED
        if topic in _NAMED_ONLY or topic.startswith(INTERNAL):
            return Reason.NAMED_ONLY
        is_command = obeyed or any(is_command_topic(channel, one) for one in types or [""])
        return Reason.COMMAND if is_command else None


def check_rules(rules: Rules) -> None:
    """Raise UsageError for a prefix that is not a namespace."""
    prefix = rules.prefix
    if prefix and not all(one.isidentifier() and one.isascii() for one in prefix.split("/")):
        hint = "a namespace is letters, digits and '_', for example robot7"
        raise UsageError(f"'{prefix}' is not a namespace", hint)
    if is_hidden(prefix):
        raise UsageError(f"'{prefix}' is a hidden name", "a part of it begins with '_'")


def _topic(channel: str) -> str:
    """Return the name to which rules apply: for a service's two channels, the service's."""
    for ending in _OF_SERVICE:
        channel = channel.removesuffix(ending)
    return channel
