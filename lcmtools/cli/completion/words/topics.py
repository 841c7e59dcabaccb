"""Topics on the bus, and field paths behind them."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.graph.model import Graph
from lcmtools.names import is_hidden

TOPIC = ("topic", "topics", "words")
"""What parameters are called that are topics."""


def topics(situation: Situation) -> Iterator[Candidate]:
    """The topics, but for hidden ones; those too where the word is one.

    A word without a slash may be a plain channel's name, or one that stands in the namespace.
    """
    given = {name for key in TOPIC for name in situation.given.get(key, ())}
    for name in situation.graph.topic_names():
        spelled = relative(name, situation)
        if spelled not in given and (not is_hidden(name) or is_hidden(situation.word)):
            yield Candidate(spelled, " or ".join(types_of(situation.graph, name)))


def topics_and_fields(situation: Situation) -> Iterator[Candidate]:
    """The topics; behind one that is written out, with a dot or a slash, its fields."""
    yield from topics(situation)
    if not any(mark in situation.word[1:] for mark in "./["):
        return
    from lcmtools.cli.completion.words.fields import fields_behind
    from lcmtools.messages.path import splits

    for topic, path in splits(situation.word):
        name = topic_meant(situation, topic)
        if name and path:
            for field in fields_behind(types_of(situation.graph, name), path):
                yield Candidate(f"{topic}{field.value}", field.help, field.is_open)
            return


def relative(name: str, situation: Situation) -> str:
    """A topic's or service's name as the word begins: in full, or within the namespace."""
    if not situation.word or situation.word.startswith("/") or not name.startswith("/"):
        return name
    return name.removeprefix(situation.namespace.rstrip("/")).removeprefix("/")


def topic_meant(situation: Situation, word: str) -> str | None:
    """The topic on the bus that a word means; None where there is none."""
    from lcmtools.names import spellings

    known = set(situation.graph.topic_names())
    return next((name for name in spellings(word, situation.namespace) if name in known), None)


def types_of(graph: Graph, name: str) -> tuple[str, ...]:
    """The types announced for a topic, else the likeliest by its fingerprint."""
    topic = graph.topic(name)
    if topic.types:
        return topic.types
    from lcmtools.messages.registry import candidates

    return tuple(one for f in topic.fingerprints for one in candidates(f)[:1])
