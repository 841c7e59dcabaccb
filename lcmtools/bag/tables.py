"""Messages as tables: comma-separated values, JSON lines, NumPy's arrays, Parquet."""

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack
from itertools import chain, count
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any

from lcmtools.bag.columns import TIME, require_columns, table, with_times
from lcmtools.errors import DecodeError, UsageError, needing_extra
from lcmtools.formats.strict_json import write_json
from lcmtools.messages.fields import stamp
from lcmtools.messages.plain import Cell, Plain, cells, to_plain
from lcmtools.messages.registry import Message, type_name
from lcmtools.names import as_utf_8
from lcmtools.observe.formatter import csv_line, merged_columns
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    from lcmtools.bag.columns import Array

OnOmission = Callable[[str, str], None]  # called with a reason and a sentence


class _TopicFiles:
    """The paths of files, one per topic, in a folder; for a single topic, the target itself."""

    def __init__(self, target: Path, suffix: str) -> None:
        self._target, self._suffix = target, suffix
        self._is_folder = not target.suffix
        self._topic = ""
        self._taken: set[str] = set()
        if self._is_folder:
            target.mkdir()

    def path(self, topic: str) -> Path:
        """Return the path of a new topic's file; UsageError if the only file is taken."""
        if self._is_folder:
            usual = file_name(topic)
            names = chain([usual], (f"{usual}_{number}" for number in count(2)))
            # some file systems ignore case
            name = next(name for name in names if name.lower() not in self._taken)
            self._taken.add(name.lower())
            return self._target / f"{name}{self._suffix}"
        if self._topic and self._topic != topic:
            raise UsageError(
                f"{self._target.name} holds one topic, and there are {self._topic} and {topic}",
                f"name one topic; or a folder, and --format {self._suffix[1:]}",
            )
        self._topic = topic
        return self._target


def file_name(topic: str) -> str:
    """Return the usual name of a topic's file, without its suffix: "husky0_odometry"."""
    name = "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in topic)
    return name.strip("_.") or "topic"


class CsvFiles(AbstractContextManager["CsvFiles"]):
    """Comma-separated values, a file for each topic, as ``echo --csv`` prints them.

    The columns are those of the longest arrays. A path without a suffix is a folder, which is
    created.
    """

    def __init__(self, path: Path) -> None:
        self._files = _TopicFiles(path, ".csv")
        self._stack = ExitStack()
        self._tables: dict[str, _CsvFile] = {}

    def __exit__(self, *_: object) -> None:
        """Close the files; raises OSError."""
        self._stack.close()

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message's row; raises DecodeError and OSError."""
        message = decoder.decode(packet)
        topic, kind = packet.channel, type_name(message)
        if topic not in self._tables:
            file = self._stack.enter_context(_CsvFile(self._files.path(topic), kind))
            self._tables[topic] = file
        stamped = stamp(message)
        time = packet.time if stamped is None else stamped
        self._tables[topic].add({TIME: time, **cells(to_plain(message))}, kind)


class _CsvFile(AbstractContextManager["_CsvFile"]):
    """The rows of messages of one type; they are written at the end, when all columns are known."""

    def __init__(self, path: Path, kind: str) -> None:
        self._path, self._kind = path, kind
        self._rows = TemporaryFile("w+", encoding="ascii")  # noqa: SIM115 - closed on exit
        self._columns: list[str] = []
        self._known: set[str] = set()
        self._columns_of: dict[int, list[str]] = {}  # by the number of values in a row

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Write the file, unless an error has occurred; raises OSError."""
        with self._rows:
            if kind is None:
                self._write()

    def add(self, row: Mapping[str, Cell], kind: str) -> None:
        """Add a message's row; DecodeError if it has another type than the first."""
        if kind != self._kind:
            raise DecodeError(f"of {kind}, and {self._kind} came before")
        if not row.keys() <= self._known:
            self._columns = merged_columns(self._columns, list(row))
            self._known = set(self._columns)
            self._columns_of[len(self._columns)] = self._columns
        self._rows.write(json.dumps([row.get(column, "") for column in self._columns]) + "\n")

    def _write(self) -> None:
        self._rows.seek(0)
        with self._path.open("x", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"{csv_line(self._columns)}\n")
            for line in self._rows:
                values = json.loads(line)
                if len(values) < len(self._columns):
                    row = dict(zip(self._columns_of[len(values)], values, strict=True))
                    values = [row.get(column, "") for column in self._columns]
                file.write(f"{csv_line(values)}\n")


class JsonLines(AbstractContextManager["JsonLines"]):
    """A line of JSON for each message: topic, time [ns], sender if known, type, message.

    Where other types have the same fields, and no node has announced its own, ``types`` has all.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("x", encoding="utf-8", errors="backslashreplace")

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self._file.close()

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message's line; raises DecodeError and OSError."""
        message = decoder.decode(packet)
        sender = packet.sender.name if packet.sender else ""
        row: dict[str, Plain] = {"topic": packet.channel, "time": packet.time}
        row |= {"sender": sender} if sender else {}
        names: list[Plain] = [*decoder.types(packet)]
        row |= {"type": names[0], **({"types": names} if len(names) > 1 else {})}
        row |= {"message": to_plain(message)}
        self._file.write(f"{write_json(row)}\n")


class ColumnsOfTopics(AbstractContextManager["ColumnsOfTopics"], ABC):
    """Arrays of all messages of each topic, created at the end."""

    def __init__(self, path: Path, on_omission: OnOmission) -> None:
        self._path, self._on_omission = path, on_omission
        self._packets: dict[str, tuple[type[Message], list[int], list[bytes]]] = {}

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Write the arrays, unless an error has occurred; raises OSError."""
        if kind is None:
            self.write(self.tables())

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Add a message; DecodeError if its type is unknown, contains itself or has changed."""
        cls = decoder.message_class(packet)
        require_columns(cls)
        if not -(2**63) <= packet.time < 2**63:
            raise DecodeError("the time of their recording is too far from 1970")
        first, times, payloads = self._packets.setdefault(packet.channel, (cls, [], []))
        if first is not cls:
            raise DecodeError(f"of {type_name(cls)}, and {type_name(first)} came before")
        times.append(packet.time)
        payloads.append(packet.payload)

    def tables(self) -> "Mapping[str, Mapping[str, Array]]":
        """Return the columns of each topic, with the times of arrival first."""
        found: dict[str, Mapping[str, Array]] = {}
        for topic, (cls, times, payloads) in self._packets.items():
            made = table(cls, payloads)
            found[topic] = with_times(times, made)
            if made.malformed:
                self._on_omission(
                    f"bad {topic}", f"{len(made.malformed)} messages on {topic} are damaged"
                )
        return found

    @abstractmethod
    def write(self, tables: "Mapping[str, Mapping[str, Array]]") -> None:
        """Write the columns of each topic."""


class NumpyFile(ColumnsOfTopics):
    """An ``.npz`` file: the fields' arrays, for several topics named TOPIC/FIELD.

    If the lengths of an array differ between messages, FIELD has all elements one after another and
    FIELD.lengths the number for each message.
    """

    def write(self, tables: "Mapping[str, Mapping[str, Array]]") -> None:
        """Write the file."""
        import numpy as np

        arrays: dict[str, Any] = {}
        for topic, columns in tables.items():
            start = "" if len(tables) == 1 else f"{as_utf_8(topic)}/"
            for name, column in columns.items():
                if column.dtype != object:
                    arrays[start + name] = column
                    continue
                rows = [np.asarray(row) for row in column]
                filled = [row.ravel() for row in rows if row.size]  # empty ones have no type
                if any(row.dtype == object for row in filled):
                    self._on_omission(
                        f"{topic} {name}", f"{topic}/{name} is left out: arrays in arrays"
                    )
                    continue
                arrays[f"{start}{name}"] = np.concatenate(filled or [np.empty(0)])
                arrays[f"{start}{name}.lengths"] = np.array([row.size for row in rows])
        with self._path.open("xb") as file:
            np.savez_compressed(file, **arrays)


class ParquetFiles(ColumnsOfTopics):
    """A Parquet file for each topic; for a single one the target, without a suffix a folder.

    Raises:
        MissingExtra: pyarrow is missing.
    """

    def __init__(self, path: Path, on_omission: OnOmission) -> None:
        super().__init__(path, on_omission)
        with needing_extra("parquet", "Parquet needs"):
            import pyarrow as pa  # noqa: F401 - before anything is read

    def write(self, tables: "Mapping[str, Mapping[str, Array]]") -> None:
        """Write the files."""
        import pyarrow as pa
        from pyarrow import parquet

        files = _TopicFiles(self._path, ".parquet")
        for topic, columns in tables.items():
            arrays = {name: _arrow(column) for name, column in columns.items()}
            parquet.write_table(pa.table(arrays), files.path(topic))


def _arrow(column: "Array") -> Any:  # noqa: ANN401 - a pyarrow object
    import pyarrow as pa

    if column.ndim == 1 and column.dtype != object:
        return pa.array(column)
    if column.dtype == object or 0 in column.shape:
        return pa.array(_lists(column))
    rows = pa.array(column.ravel())
    for size in reversed(column.shape[1:]):
        rows = pa.FixedSizeListArray.from_arrays(rows, size)
    return rows


def _lists(rows: object) -> object:
    """Return an array as lists, also where its elements are arrays of different lengths."""
    import numpy as np

    if not isinstance(rows, np.ndarray):
        return rows
    return list(map(_lists, rows)) if rows.dtype == object else rows.tolist()
