"""The summary of a log as lines of text and as values for JSON."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from datetime import datetime, timezone

from lcmtools.bag.summary import LogSummary, TopicSummary
from lcmtools.graph.drawing.labels import printable
from lcmtools.observe.reports.describe import kinds_text, size_text
from lcmtools.text_table import plural, text_table

_LEVELS = " ▁▂▃▄▅▆▇█"
_HEAD = ("TOPIC", "TYPE", "MESSAGES", "RATE", "SIZE", "TOTAL", "LONGEST GAP", "SENDERS")


def time_text(time: int) -> str:
    """Return a time [ns since 1970] in the computer's time zone, and in seconds."""
    milliseconds = abs(time) // 1_000_000
    sign = "-" if time < 0 and milliseconds else ""
    seconds = f"{sign}{milliseconds // 1000}.{milliseconds % 1000:03}"
    with suppress(ValueError, OverflowError, OSError):  # outside of years with four digits
        moment = datetime.fromtimestamp(time / 1e9, timezone.utc).astimezone()
        return f"{moment:%Y-%m-%d %H:%M:%S}.{moment.microsecond // 1000:03} ({seconds})"
    return seconds


def span_text(seconds: float) -> str:
    """Return a time span as text: "12.3 s", "1m 32s", "2h 05m"."""
    if seconds < 60:  # noqa: PLR2004 - seconds of a minute
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}h {minutes:02}m" if hours else f"{minutes}m {rest:02}s"


def to_lines(summary: LogSummary) -> list[str]:
    """Return the lines of a log's summary, and below the table of its topics."""
    topics = ["", *text_table([_HEAD, *map(_cells, summary.topics)])] if summary.topics else []
    return [*text_table([*_facts(summary)]), *topics]


def to_json(summary: LogSummary) -> dict[str, object]:
    """Return the same for JSON; times are nanoseconds since 1970."""
    return {
        "path": summary.path,
        "bytes": summary.bytes,
        "indexed_bytes": summary.indexed,
        "damaged_bytes": summary.damaged,
        "messages": summary.messages,
        "start": summary.start if summary.messages else None,
        "end": summary.end if summary.messages else None,
        "duration": summary.duration,
        "disorder": summary.disorder / 1e9,
        "nodes": list(summary.nodes),
        "losses": [
            {
                "sender": str(sender),
                "lost": loss.lost,
                "of": loss.sent,
                "times": [
                    {"time": time, "lost": found.lost, "of": found.sent}
                    for time, one, found in summary.loss_times
                    if one == sender
                ],
            }
            for sender, loss in summary.losses.items()
        ],
        "histogram": list(summary.histogram),
        "topics": [
            {
                "topic": topic.name,
                "types": list(topic.types),
                "fingerprints": [f"{number:#018x}" for number in topic.fingerprints],
                "messages": topic.messages,
                "bytes": topic.bytes,
                "rate": topic.rate,
                "start": topic.first_time,
                "end": topic.last_time,
                "longest_gap": topic.longest_gap / 1e9,
                "senders": dict(topic.senders),
            }
            for topic in summary.topics
        ],
    }


def _facts(summary: LogSummary) -> Iterator[tuple[str, str]]:
    """Yield what is known of the whole log, each a key and a value."""
    yield "path:", summary.path
    yield "size:", f"{size_text(summary.bytes)} in {plural(summary.messages, 'message')}"
    if summary.messages:
        yield "duration:", span_text(summary.duration)
        yield "start:", time_text(summary.start)
        yield "end:", time_text(summary.end)
    yield "index:", _index_text(summary)
    if summary.damaged:
        what = f"{size_text(summary.damaged)} do not belong to any message"
        yield "damaged:", f"{what}; lcmtools bag fix shows where"
    if summary.disorder:
        what = f"times go back, by up to {span_text(summary.disorder / 1e9)}"
        yield "order:", f"{what}; lcmtools bag sort sorts the messages"
    if summary.nodes:
        yield "nodes:", ", ".join(summary.nodes)
    lost = [f"{loss} of {sender}" for sender, loss in summary.losses.items() if loss.lost]
    for number, text in enumerate(lost):
        yield "" if number else "lost:", f"{text}, before they were recorded"
    if summary.messages:
        yield "activity:", _spark_line(summary.histogram)


def _cells(topic: TopicSummary) -> Sequence[str]:
    return (
        printable(topic.name),
        kinds_text(topic.kinds, topic.name),
        str(topic.messages),
        "-" if topic.rate is None else f"{topic.rate:.2f} Hz",
        size_text(topic.mean_bytes),
        size_text(topic.bytes),
        span_text(topic.longest_gap / 1e9) if topic.messages > 1 else "-",
        ", ".join(topic.senders) or "-",
    )


def _index_text(summary: LogSummary) -> str:
    if summary.indexed == summary.bytes:
        return "complete"
    if summary.path == "-":
        return "none"
    if not summary.indexed:
        return "none; lcmtools bag reindex writes one"
    return f"of the first {size_text(summary.indexed)}; lcmtools bag reindex completes it"


def _spark_line(histogram: Sequence[int]) -> str:
    """Return the messages over time as bars of eight heights; a blank for none."""
    most = max(histogram) or 1
    return "".join(_LEVELS[-(-8 * count // most)] for count in histogram)
