"""Completers for what is in logs: topics."""

import contextlib
from collections.abc import Iterator
from itertools import islice

from lcmtools.cli.completion.situation import Candidate, Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.names import is_hidden

_MOST_EVENTS = 20_000  # that are looked at in a log without an index


def topics(situation: Situation) -> Iterator[Candidate]:
    """The topics of the logs that are named; by the beginning of one that has no index."""
    from lcmtools.observe.log_file import LogFile

    found: set[str] = set()
    for path in situation.all("files", "source"):
        with contextlib.suppress(LcmtoolsError), LogFile(path) as log:
            found.update(*(block.channels for block in log.index.blocks))
            events = islice(log.events(log.index.end), _MOST_EVENTS)
            found.update(event.channel for event in events)
    yield from (Candidate(name) for name in sorted(found) if not is_hidden(name))
