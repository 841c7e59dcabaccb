"""The input of a completion function, a situation, and its output, candidates."""

import os
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, cast

from lcmtools.cli.completion import Source
from lcmtools.errors import LcmtoolsError
from lcmtools.forks import cached_property

if TYPE_CHECKING:  # imported only to observe the bus
    from lcmtools.bus.url import BusUrl
    from lcmtools.graph.model import Graph, NodeInfo


class Candidate(NamedTuple):
    """A word that could be at the cursor, as the command receives it."""

    value: str
    help: str = ""  # for shells that show one
    is_open: bool = False  # more may follow without a blank, as after a package's name and slash


FILES = Candidate("")  # the files, which the shell itself completes


class Situation:
    """The words before the cursor, and the bus at a glance.

    ``word`` is the part that is typed, as the command would receive it; ``given`` has the words
    before, by the parameters' names.
    """

    def __init__(
        self,
        word: str = "",
        given: Mapping[str, Sequence[str]] = MappingProxyType({}),
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self.word, self.given, self.environment = word, given, environment

    def all(self, *names: str) -> list[str]:
        """Return everything given for these parameters."""
        return [value for name in names for value in self.given.get(name, ())]

    def first(self, *names: str) -> str:
        """Return the first value given for one of these parameters, or ""."""
        return next(iter(self.all(*names)), "")

    def last(self, name: str) -> str:
        """Return the value given last for a parameter, or ""."""
        return next(reversed(self.all(name)), "")

    def at(self, word: str) -> "Situation":
        """Return the same situation with another word. The bus is observed only once."""
        other = Situation(word, self.given, self.environment)
        if "graph" in self.__dict__:
            other.__dict__["graph"] = self.graph
        return other

    @property
    def is_global(self) -> bool:
        """True if names are to be completed in full: the word may begin with a slash."""
        return not self.word or self.word.startswith("/")

    @cached_property
    def graph(self) -> "Graph":
        """The graph of the bus or the log; empty if it cannot be read."""
        from lcmtools.bus.quick_probe import QuickProbe

        try:
            if log := self.last("bag"):
                from lcmtools.cli.completion.recorded import recorded_graph

                return recorded_graph(log)
            if self.url.provider == "zenoh":  # other providers do not announce on request
                return self._discovered()
            with QuickProbe(self.url) as quick_probe:
                from lcmtools.cli.completion.recent_channels import with_recent_channels

                seen = quick_probe.graph(self._silent_nodes)
                bus = f"{self.url.host}-{self.url.port}"
                return with_recent_channels(seen, bus, self.environment)
        except (LcmtoolsError, OSError):
            from lcmtools.graph.model import Graph

            return Graph()

    def _discovered(self) -> "Graph":
        """Return the nodes of a bus that is not multicast, which takes longer."""
        from lcmtools.observe.reading.monitor import BusMonitor

        with BusMonitor(self.url, "complete", self.environment) as monitor:
            return monitor.discover()

    @cached_property
    def url(self) -> "BusUrl":
        """The bus that the command would use."""
        from lcmtools.bus.url import choose_url
        from lcmtools.settings import read_user_file

        given = self.last("lcm_url"), self.last("domain")
        return choose_url(*given, self.environment, read_user_file(self.environment))[0]

    @cached_property
    def namespace(self) -> str:
        """The namespace of relative names."""
        from lcmtools.names import resolve_namespace
        from lcmtools.settings import usual_namespace

        try:
            return resolve_namespace(self.last("ns") or usual_namespace(self.environment))
        except LcmtoolsError:
            return "/"

    def _silent_nodes(self, answered: Container[str]) -> "Iterator[NodeInfo]":
        """Yield the nodes that run on this computer and have not answered."""
        from lcmtools.bus.records import NodeRecords
        from lcmtools.graph.model import Staleness

        for node in NodeRecords(self.url, self.environment).read(but=answered):
            if node.stale is Staleness.HANGS:
                yield node


CompletionFunction = Callable[[Situation], Iterable[Candidate]]


def candidates(source: Source, situation: Situation) -> list[Candidate]:
    """Return the candidates of a source. Some may not begin with the situation's word."""
    if not isinstance(source, str):
        return [Candidate(words[0], "".join(words[1:])) for words in source]
    if source == "files":
        return [FILES]
    if not source:
        return []
    module, _, function = source.partition(":")
    home = import_module(module if "." in module else f"{__package__}.{module}")
    return list(cast(CompletionFunction, getattr(home, function))(situation))
