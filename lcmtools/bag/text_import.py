"""Importing JSON lines, as ``bag export`` writes them, and comma-separated values of one type."""

import csv
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

from lcmtools.bag.columns import TIME
from lcmtools.clock import split_stamp
from lcmtools.errors import InvalidFile, LcmtoolsError, UsageError, os_errors_as
from lcmtools.messages.codec import encode
from lcmtools.messages.dicts import from_dict
from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.registry import Message, message_class
from lcmtools.wire.packet import Packet, Sender

SUFFIXES = (".jsonl", ".ndjson", ".csv")
_KEYS = ("topic", "time", "type", "message")
_MOST_TOLD = 5  # lines that are named


def text_packets(
    path: Path,
    type_: str | None = None,
    topic: str | None = None,
    on_omission: Callable[[str], None] = lambda _: None,
) -> Iterator[Packet]:
    """Yield the messages of a file; ``on_omission`` is called with what is left out.

    Args:
        path: A file of JSON lines or of comma-separated values, by its suffix.
        type_: The type of the values, which a file of them does not have.
        topic: The topic of the values; for JSON lines, instead of their own.
        on_omission: Called with a sentence on each of the first lines that cannot be read, and on
            the number of the others.

    Raises:
        UsageError: The type or the topic of values is missing, or is not known.
        InvalidFile: The file cannot be read, or nothing in it can.
    """
    is_csv = path.suffix == ".csv"
    if is_csv and not (type_ and topic):
        what = "a file of values has no type and no topic"
        raise UsageError(what, "add --type PACKAGE/NAME and --as TOPIC")
    cls = message_class(type_) if type_ else None
    with (
        os_errors_as(f"cannot read {path}", kind=InvalidFile),
        path.open(encoding="utf-8", errors="surrogateescape", newline="") as lines,
    ):
        rows = _csv_rows(lines, cls, topic or "") if is_csv and cls else _json_rows(lines, topic)
        yield from _readable(path, rows, on_omission)


def _readable(
    path: Path, rows: Iterable[Callable[[], Packet]], on_omission: Callable[[str], None]
) -> Iterator[Packet]:
    count = left_out = 0
    for number, read in enumerate(rows, 1):
        try:
            packet = read()
        except (LcmtoolsError, ValueError, TypeError, KeyError, RecursionError) as error:
            left_out += 1
            why = error.what if isinstance(error, LcmtoolsError) else error
            if left_out <= _MOST_TOLD:
                on_omission(f"{path}: message {number} is left out: {why}")
            continue
        count += 1
        yield packet
    if left_out > _MOST_TOLD:
        on_omission(f"{path}: {left_out - _MOST_TOLD} more messages are left out")
    if not count:
        raise InvalidFile(f"nothing is imported: {path} has no message that can be read")


def _json_rows(lines: Iterable[str], topic: str | None) -> Iterator[Callable[[], Packet]]:
    senders: dict[str, Sender] = {}

    def packet(line: str) -> Packet:
        row = json.loads(line)
        if not isinstance(row, dict) or any(key not in row for key in _KEYS):
            raise InvalidFile(f"it is not {', '.join(_KEYS)}, as bag export writes")
        name = str(row.get("sender", ""))
        if name and name not in senders:
            senders[name] = Sender("0.0.0.0", len(senders) + 1, name)  # noqa: S104 - unknown
        message = from_dict(message_class(str(row["type"])), row["message"])
        channel = topic or str(row["topic"])
        return Packet(channel, encode(message), int(row["time"]), senders.get(name))

    for line in filter(str.strip, lines):
        yield lambda line=line: packet(line)  # type: ignore[misc] # read at once


def _csv_rows(
    lines: Iterable[str], cls: type[Message], topic: str
) -> Iterator[Callable[[], Packet]]:
    rows = csv.DictReader(lines)
    columns = tuple(rows.fieldnames or ())
    if TIME not in columns:
        raise InvalidFile(f"there is no column {TIME}", "lcmtools bag export writes one")
    reader = _RowReader(columns)

    def packet(row: Mapping[str, str]) -> Packet:
        message = from_dict(cls, reader.message(cls, "field", row))
        return Packet(topic, encode(message), int(row[TIME]))

    for row in rows:
        yield lambda row=row: packet(row)  # type: ignore[misc] # read at once


class _RowReader:
    """Reads the columns of ``messages.plain.cells``."""

    def __init__(self, columns: tuple[str, ...]) -> None:
        self._columns = columns
        self._has = cache(self._find)

    def message(self, cls: type[Message], name: str, row: Mapping[str, str]) -> dict[str, object]:
        found = {}
        for part in visible_fields(cls):
            value = self._value(part, f"{name}.{part.name}", part.depth, "", row)
            if value is not None:
                found[part.name] = value
        return found

    def _value(
        self, part: Field, name: str, depth: int, joint: str, row: Mapping[str, str]
    ) -> object:
        if depth:
            values: list[object] = []
            while self._has(item := f"{name}{joint}{len(values)}"):
                value = self._value(part, item, depth - 1, "_", row)
                if value is None:
                    break
                values.append(value)
            return values
        cls = part.message_class
        if cls and is_time(cls):
            return _time(cls, row.get(name)) if row.get(name) else None
        if cls:
            inside = self._has(name) and any(
                row.get(one) for one in self._columns if one.startswith(f"{name}.")
            )
            return self.message(cls, name, row) if inside else None
        text = row.get(name)
        if text is None or (text == "" and part.type != "string"):
            return None
        return _scalar(part, text)

    def _find(self, name: str) -> bool:
        starts = f"{name}.", f"{name}_"
        return any(one == name or one.startswith(starts) for one in self._columns)


def _time(cls: type[Message], text: str | None) -> dict[str, object]:
    names = [part.name for part in visible_fields(cls)]
    return dict(zip(names, split_stamp(int(text or 0)), strict=True))


def _scalar(part: Field, text: str) -> object:
    if part.type == "string":
        return text
    if part.type == "bool":
        return text not in ("0", "False", "false")
    if str(part.type).startswith("float"):
        return float(text)
    try:
        return int(text)
    except ValueError:
        return text  # the name of an enum
