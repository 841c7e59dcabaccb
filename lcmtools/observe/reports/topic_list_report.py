"""A list of topics as lines of text, in rostopic's words, and as values for JSON."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from lcmtools.graph.model import Topic
from lcmtools.observe.reading.senders import Program
from lcmtools.observe.reports.describe import by_computer, topic_kinds, type_text, types_json
from lcmtools.observe.reports.program_report import listeners_json, listeners_text


class TopicList(NamedTuple):
    """The choice of the listed topics, and their form."""

    published: bool  # list the published topics
    subscribed: bool
    verbose: bool  # in sections, as in rostopic
    types: bool  # show each topic's type
    rates: Mapping[str, float] | None  # [Hz] by topic; None if not shown
    listeners: Sequence[Program] | None = ()  # that may subscribe to any topic; None if unseen

    def has(self, topic: Topic) -> bool:
        """Return whether a topic is listed."""
        has_publisher = bool(topic.publishers or topic.traffic)
        return (self.published and has_publisher) or (self.subscribed and bool(topic.subscribers))

    def to_lines(self, topics: Sequence[Topic]) -> list[str]:
        """Return the lines of topics."""
        if self.verbose:
            return self._sections(topics)
        names = [f"{t.name} [{type_text(t)}]" if self.types else t.name for t in topics]
        if self.rates is None:
            return names
        width = max(map(len, names), default=0)
        rates = map(self._rate_text, topics)
        return [f"{name:<{width}}  {rate}" for name, rate in zip(names, rates, strict=True)]

    def rows_by_host(self, topics: Sequence[Topic]) -> list[str]:
        """Return the same for each computer, indented, as in rostopic list --host."""
        rows = []
        for host, there in by_computer(topics).items():
            if shown := list(filter(self.has, there)):
                rows += [f"Host [{host}]:", *(f"  {row}".rstrip() for row in self.to_lines(shown))]
        return rows

    def to_json(self, topic: Topic) -> dict[str, object]:
        """Return a topic for JSON."""
        record: dict[str, object] = {
            "topic": topic.name,
            **types_json(topic_kinds(topic), topic.name),
            "publishers": [node.name for node, _ in topic.publishers],
            "subscribers": [node.name for node, _ in topic.subscribers],
            "other_senders": [seen.sender and str(seen.sender) for seen in topic.foreign],
            "possible_subscribers": listeners_json(self.listeners),
        }
        return record if self.rates is None else {**record, "rate": self.rates.get(topic.name)}

    def _sections(self, topics: Sequence[Topic]) -> list[str]:
        published = {topic: len(topic.publishers) + len(topic.foreign) for topic in topics}
        subscribed = {topic: len(topic.subscribers) for topic in topics}
        sections = (
            (self.published, "Published topics:", published, "publisher"),
            (self.subscribed, "Subscribed topics:", subscribed, "subscriber"),
        )
        rows = [""]
        for is_shown, title, counts, noun in sections:
            if is_shown:
                rows += [title, *(self._row(t, n, noun) for t, n in counts.items() if n)]
                unseen = listeners_text(self.listeners) if noun == "subscriber" else ""
                rows += [f" * not known: {unseen}"] * bool(unseen) + [""]
        return rows

    def _row(self, topic: Topic, count: int, noun: str) -> str:
        rate = "" if self.rates is None else f", {self._rate_text(topic)}"
        counted = f"{count} {noun}{'s' if count != 1 else ''}"
        return f" * {topic.name} [{type_text(topic)}] {counted}{rate}"

    def _rate_text(self, topic: Topic) -> str:
        rate = (self.rates or {}).get(topic.name)
        return "-" if rate is None else f"{rate:.2f} Hz"
