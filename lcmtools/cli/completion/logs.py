"""Completers for the topics of logs."""

import contextlib
from collections.abc import Iterator

from lcmtools.cli.completion.recorded import recorded_graph
from lcmtools.cli.completion.situation import Candidate, Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.names import is_hidden


def topics(situation: Situation) -> Iterator[Candidate]:
    """Complete the topics of the named logs; without an index, from the log's beginning."""
    found: set[str] = set()
    for path in situation.all("files", "source"):
        with contextlib.suppress(LcmtoolsError):
            found.update(one.channel for one in recorded_graph(path).traffic)
    yield from (Candidate(name) for name in sorted(found) if not is_hidden(name))
