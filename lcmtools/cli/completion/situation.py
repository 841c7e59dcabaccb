"""What is known where a word is to be completed: the words before it, and the bus at a glance."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

from lcmtools.errors import LcmtoolsError

if TYPE_CHECKING:  # imported where the bus is wanted
    from lcmtools.bus.url import BusUrl
    from lcmtools.graph.model import Graph


@dataclass(frozen=True)
class Situation:
    """Where the cursor is.

    Attributes:
        command: The command's words ("node", "info").
        word: What is typed of the word so far, as the command would get it.
        given: The arguments and option values before it, by the parameter's name.
        environment: The environment variables.
    """

    command: Sequence[str]
    word: str
    given: Mapping[str, Sequence[str]] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=lambda: os.environ)

    def value(self, *names: str) -> str:
        """What was given last for one of these parameters; "" for nothing."""
        return next((self.given[name][-1] for name in names if self.given.get(name)), "")

    def first(self, *names: str) -> str:
        """What was given first for one of these parameters; "" for nothing."""
        return next((self.given[name][0] for name in names if self.given.get(name)), "")

    def at(self, word: str) -> "Situation":
        """The same situation with another word; the bus is not looked at twice."""
        other = replace(self, word=word)
        if "graph" in self.__dict__:
            other.__dict__["graph"] = self.graph
        return other

    @cached_property
    def graph(self) -> "Graph":
        """What is on the bus; nothing where it cannot be reached."""
        from lcmtools.bus.quick_probe import QuickProbe

        try:
            with QuickProbe(self.url) as quick_probe:
                from lcmtools.cli.completion.heard import with_heard

                seen = quick_probe.graph(self._running())
                return with_heard(seen, f"{self.url.host}-{self.url.port}", self.environment)
        except (LcmtoolsError, OSError):
            from lcmtools.graph.model import Graph

            return Graph()

    @cached_property
    def url(self) -> "BusUrl":
        """The bus that the command would use.

        Raises:
            UsageError: What is said of it is wrong.
        """
        from lcmtools.bus.url import choose_url
        from lcmtools.settings import read_user_file

        said = self.value("lcm_url"), self.value("domain")
        return choose_url(*said, self.environment, read_user_file(self.environment))[0]

    @cached_property
    def namespace(self) -> str:
        """The namespace that relative names stand in."""
        from lcmtools.names import resolve_namespace
        from lcmtools.settings import usual_namespace

        try:
            return resolve_namespace(self.value("ns") or usual_namespace(self.environment))
        except LcmtoolsError:
            return "/"

    def _running(self) -> Iterator[str]:
        """The ids of this computer's nodes that left a record and run."""
        from lcmtools.bus.records import NodeRecords
        from lcmtools.graph.model import Staleness

        for node in NodeRecords(self.url, self.environment).read():
            if node.stale is Staleness.HANGS:  # as it would, if it did not answer
                yield node.id
