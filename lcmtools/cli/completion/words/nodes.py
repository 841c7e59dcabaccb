"""Nodes on the bus, the computers they run on, and the namespaces that names stand in."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import FILES, Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.names import base_name_of, is_hidden, namespace_of


def nodes(situation: Situation) -> Iterator[Candidate]:
    """The nodes by their full names; by the last part where the word has no slash."""
    given = {name for key in ("node", "nodes") for name in situation.given.get(key, ())}
    is_short = bool(situation.word) and not situation.word.startswith("/")
    for node in situation.graph.nodes:
        name = base_name_of(node.name) if is_short else node.name
        is_wanted = is_hidden(situation.word) or not (node.is_hidden or node.tool)
        if is_wanted and not {name, node.name} & given:
            yield Candidate(name, f"{node.host}, pid {node.pid}")


def hosts(situation: Situation) -> Iterator[Candidate]:
    """The computers that nodes run on."""
    yield from (Candidate(host) for host in sorted({n.host for n in situation.graph.nodes}))


def namespaces(situation: Situation) -> Iterator[Candidate]:
    """The namespaces of topics and nodes, and those that they stand in."""
    names = [*situation.graph.topic_names(), *(node.name for node in situation.graph.nodes)]
    found: set[str] = set()
    for name in names:
        while name.startswith("/") and (name := namespace_of(name)) != "/":
            found.add(name)
    for name in sorted(found):
        if not is_hidden(name) or is_hidden(situation.word):
            is_global = not situation.word or situation.word.startswith("/")
            yield Candidate(name if is_global else name.removeprefix("/"))


def names(situation: Situation) -> Iterator[Candidate]:
    """Whatever has a name: topics, nodes, and the namespaces they stand in."""
    from lcmtools.cli.completion.words.topics import topics

    given = {name for key in ("namespace", "excluded") for name in situation.given.get(key, ())}
    found = (*namespaces(situation), *topics(situation), *nodes(situation))
    yield from (one for one in found if one.value not in given)


def nodes_and_files(situation: Situation) -> Iterator[Candidate]:
    """Nodes; files where the word begins no node."""
    yield from nodes(situation)
    yield FILES


def nodes_behind_a_file(situation: Situation) -> Iterator[Candidate]:
    """A file first, and a node behind it."""
    if situation.given.get("words"):
        yield from nodes(situation)
    else:
        yield FILES
