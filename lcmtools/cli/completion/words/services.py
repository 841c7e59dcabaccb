"""Services that nodes announce."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.cli.completion.words.topics import relative
from lcmtools.graph.model import Endpoint, Role
from lcmtools.names import is_hidden, spellings


def services(situation: Situation) -> Iterator[Candidate]:
    """The services, but for hidden ones; those too where the word is one."""
    given = {name for key in ("service", "services") for name in situation.given.get(key, ())}
    for endpoint in announced(situation):
        name = relative(endpoint.topic, situation)
        if name not in given and (not is_hidden(endpoint.topic) or is_hidden(situation.word)):
            yield Candidate(name, endpoint.type)


def service_type(situation: Situation) -> str:
    """The type of the service that stands before; "" where nobody announces it."""
    names = spellings(situation.first("service", "services"), situation.namespace)
    return next((one.type for one in announced(situation) if one.topic in names), "")


def announced(situation: Situation) -> list[Endpoint]:
    """The services that nodes announce, sorted by name."""
    found = (one for node in situation.graph.nodes for one in node.having(Role.SERVICE))
    return sorted(found, key=lambda endpoint: endpoint.topic)
