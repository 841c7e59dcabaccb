"""Messages as text, JSON and comma-separated values, whole or in parts, as echo shows them."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from lcmtools.errors import DecodeError, UnknownType, UsageError, ValueMismatch
from lcmtools.formats.strict_json import write_json
from lcmtools.messages.fields import MessageClass, stamp
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import Path, SelectedValue, select, target
from lcmtools.messages.plain import NOTHING, Cell, Plain, View, cells, plain_value
from lcmtools.messages.registry import Message, message_class
from lcmtools.messages.text import FREE, Writer, format_message
from lcmtools.observe.reading.arrivals import SelectedPacket
from lcmtools.observe.reading.decoding import Decoder, UnknownFingerprint, remedy_of_unknown
from lcmtools.wire.packet import Packet

_SHOWN_BYTES = 64
_SLICE = "--field with a slice such as [0:5] gives all rows the same columns"

Form = Literal["text", "json", "csv", "flow", "raw", "raw json"]


@dataclass(frozen=True, slots=True)
class DisplayOptions:
    """The form in which messages are shown, and their shown parts."""

    form: Form = "text"
    fields: tuple[Path, ...] = ()  # relative to the topic's own path; empty for all of it
    condition: Filter | None = None  # that messages must fulfil
    view: View = NOTHING  # values that are shown in another way
    writer: Writer = FREE  # the format of numbers in text
    is_relative: bool = False  # times are relative to the message's arrival
    message_class: MessageClass | None = None  # None: the fingerprints decide

    @property
    def is_raw(self) -> bool:
        """True if payloads are shown as they are."""
        return self.form in ("raw", "raw json")

    def paths(self, behind_topic: Path) -> tuple[Path, ...]:
        """Return the paths of all shown parts, from the whole message."""
        paths = tuple(behind_topic.then(field) for field in self.fields) or (behind_topic,)
        if self.is_raw and any(path.steps for path in paths):
            raise UsageError("--raw shows whole messages", "leave out the field, or --raw")
        return paths

    def is_whole(self, paths: tuple[Path, ...], cls: MessageClass) -> bool:
        """Return whether messages of a type are shown whole as text, without changes."""
        is_text = self.form == "text" and self.writer == FREE and not self.is_relative
        return is_text and paths == (Path(),) and not self.view.changes(cls)

    def check(self, types: tuple[str, ...], behind_topic: Path) -> None:
        """Find unknown fields before a message arrives, if a single type is announced."""
        paths = self.paths(behind_topic)
        cls = self.message_class or _announced_class(types)
        if cls is None:
            return
        for path in paths:
            target(cls, path)
        if self.condition:
            self.condition.check(cls)


class MessageFormatter:
    """Turns packets into texts, which name their topic if it ``is_one_of_many``.

    ``notify`` is called with a sentence about what is left out, once for each reason.
    """

    def __init__(
        self,
        decoder: Decoder,
        options: DisplayOptions,
        is_one_of_many: Callable[[], bool],
        notify: Callable[[str], None],
    ) -> None:
        self._decoder, self._options = decoder, options
        self._condition, self._is_raw = options.condition, options.is_raw
        self._is_one_of_many, self._notify = is_one_of_many, notify
        self._table = CsvTable(self._notify_once)
        self._paths: dict[Path, tuple[Path, ...]] = {}
        self._whole: dict[tuple[Path, MessageClass], bool] = {}
        self._notified: set[str] = set()
        self._has_shown = False

    def learn_columns(self, found: SelectedPacket) -> str | None:
        """Add the columns of a message that is to be shown as CSV; None if it is not shown."""
        self._table.is_learning = True
        try:
            return self.text(found)
        finally:
            self._table.is_learning = False

    def text(self, found: SelectedPacket) -> str | None:
        """Return the text of a message; None if it must not be shown or has no fields.

        A message without the selected fields is left out with one notice, if others may have them.
        """
        try:
            text = self._shown(found)
        except ValueMismatch as mismatch:
            if not (self._is_one_of_many() or self._has_shown):
                raise
            channel = found.packet.channel
            self._notify_once(f"unfit {channel}", f"a message on {channel} is left out: {mismatch}")
            return None
        self._has_shown = self._has_shown or text is not None
        return text

    def _shown(self, found: SelectedPacket) -> str | None:
        paths, condition = self._paths_behind(found.path), self._condition
        if self._is_raw and not condition:
            return self._raw(found)
        try:
            message = self._decoder.decode(found.packet)
        except DecodeError as reason:
            return self._undecoded(found, reason)
        if condition and not condition.matches(message):
            return None
        return self._raw(found) if self._is_raw else self._text(found, message, paths)

    def _paths_behind(self, topic: Path) -> tuple[Path, ...]:
        if topic not in self._paths:
            self._paths[topic] = self._options.paths(topic)
        return self._paths[topic]

    def _text(self, found: SelectedPacket, message: Message, paths: tuple[Path, ...]) -> str | None:
        form = self._options.form
        whole = found.path, type(message)
        if whole not in self._whole:
            self._whole[whole] = self._options.is_whole(paths, type(message))
        if self._whole[whole]:
            return self._headed(found, f"{format_message(message)}\n---")
        selected = {str(path): select(message, path) for path in paths}
        # slices have the same columns in each row, also where an array is shorter
        widths = {str(path): path.width for path in paths} if form == "csv" else {}
        plain = _plain(selected, self._view(found), widths)
        if form == "json" and self._is_one_of_many():
            return write_json({"topic": found.packet.channel, "message": plain})
        if form == "json":
            return write_json(plain)
        if form == "csv":
            row = self._row(found, message, plain)
            return self._table.row(row, ", ".join(map(_kind, selected.values())))
        writer = self._options.writer
        text = writer.flow(plain) if form == "flow" else writer.block(plain)
        return self._headed(found, f"{text}\n---")

    def _view(self, found: SelectedPacket) -> View:
        view = self._options.view
        return view._replace(origin=found.time) if self._options.is_relative else view

    def _row(self, found: SelectedPacket, message: Message, plain: Plain) -> dict[str, Cell]:
        stamped = stamp(message)
        time = found.time if stamped is None else stamped
        topic: dict[str, Cell] = {"topic": found.packet.channel} if self._is_one_of_many() else {}
        origin = found.time if self._options.is_relative else 0
        return {"%time": time - origin, **topic, **cells(plain)}

    def _raw(self, found: SelectedPacket) -> str:
        if self._options.form == "raw json":
            return self._raw_json(found.packet)
        return self._headed(found, found.packet.payload.hex())

    def _raw_json(self, packet: Packet, **more: str) -> str:
        topic = {"topic": packet.channel} if self._is_one_of_many() else {}
        content = {"bytes": len(packet.payload), **more, "data": packet.payload.hex()}
        return write_json({**topic, **content})

    def _headed(self, found: SelectedPacket, text: str) -> str:
        """A text below its topic's name, a YAML comment, if there may be several topics."""
        if not self._is_one_of_many():
            return text
        channel = found.packet.channel
        if not channel.isprintable():  # it must not end the comment or colour the terminal
            from lcmtools.graph.drawing.labels import printable

            channel = printable(channel)
        return f"# {channel}\n{text}"

    def _undecoded(self, found: SelectedPacket, reason: DecodeError) -> str | None:
        packet = found.packet
        channel = packet.channel
        paths = self._paths_behind(found.path)
        is_all = paths == (Path(),) and not self._options.condition
        if is_all and self._options.form == "json":
            return self._raw_json(packet, error=reason.what)
        is_new = isinstance(reason, UnknownFingerprint) and not self._notified
        remedy = (reason.hint or remedy_of_unknown()) if is_new else ""
        if is_all and self._options.form in ("text", "flow"):
            if is_new:
                self._notify_once("unknown", f"no type is known for {channel}; {remedy}")
            return self._headed(found, f"{_raw_text(packet, reason.what)}\n---")
        what = f"{reason.what}; {remedy}" if is_new else reason.what
        self._notify_once(f"raw {channel}", f"a message on {channel} has no known fields: {what}")
        return None

    def _notify_once(self, about: str, text: str) -> None:
        if about not in self._notified:
            self._notified.add(about)
            self._notify(text)


def _plain(found: dict[str, SelectedValue], view: View, widths: Mapping[str, int]) -> Plain:
    """The selected values; arrays of single values are filled up to ``widths`` with empty ones."""
    plain = {path: plain_value(one.value, one.target, view) for path, one in found.items()}
    for path, width in widths.items():
        values, kind = plain[path], found[path].target
        if isinstance(values, list) and kind.depth == 1 and kind.message_class is None:
            values += [""] * (width - len(values))
    return plain if len(plain) > 1 else next(iter(plain.values()))


def _kind(selection: SelectedValue) -> str:
    """The type of a selected value, with a pair of brackets for each array around it."""
    return selection.target.type + "[]" * selection.target.depth


def _raw_text(packet: Packet, reason: str) -> str:
    """A payload that cannot be decoded, as YAML nevertheless."""
    shown = packet.payload[:_SHOWN_BYTES].hex(" ")
    more = " ..." if len(packet.payload) > _SHOWN_BYTES else ""
    return f"# {reason}\nbytes: {len(packet.payload)}\ndata: '{shown}{more}'"


class CsvTable:
    """Rows of comma-separated values under the columns of the first one, or of those it learnt.

    Rows of another type of message are left out. ``notify`` is called with the reason and a
    sentence if something is left out.
    """

    def __init__(self, notify: Callable[[str, str], None]) -> None:
        self._columns: list[str] = []
        self._kind = ""
        self._has_head = False
        self.is_learning = False  # True while rows only add columns
        self._notify = notify

    def row(self, cells: dict[str, Cell], kind: str) -> str | None:
        """The row of a message, after the line with the columns' names if it is the first.

        A column without a value in the message is empty; values without a column are left out.
        ``kind`` has the name of the values' type, or the names of several.
        """
        if not self._columns:
            self._columns, self._kind = list(cells), kind
        elif kind != self._kind:
            columns = f"the columns are those of {self._kind}"
            self._notify(f"kind {kind}", f"messages of {kind} are left out: {columns}")
            return None
        if self.is_learning:
            if not cells.keys() <= set(self._columns):
                self._columns = merged_columns(self._columns, list(cells))
            return ""
        head = "" if self._has_head else f"{csv_line(self._columns)}\n"
        self._has_head = True
        if more := len(cells.keys() - set(self._columns)):
            self._notify(
                "more",
                f"no column for {more} more in an array that was shorter in the first message;"
                f" {_SLICE}",
            )
        return head + csv_line([cells.get(column, "") for column in self._columns])


def merged_columns(columns: list[str], others: list[str]) -> list[str]:
    """Return the columns of two rows, each array's together."""
    places = {name: place for place, name in enumerate(columns)}
    merged, end = list[str](), 0
    for name in others:
        place = places.get(name)
        if place is None:
            merged.append(name)
        elif place >= end:
            merged += columns[end : place + 1]
            end = place + 1
    return merged + columns[end:]


def csv_line(cells: Sequence[Cell]) -> str:
    """Return values as comma-separated ones, without the end of the line."""
    text = io.StringIO()
    csv.writer(text).writerow(cells)  # its own line end: else a line break is not quoted
    return text.getvalue().removesuffix("\r\n")


def _announced_class(types: tuple[str, ...]) -> type[Message] | None:
    """The class of the one type that is announced; None for none, several, or an unknown one."""
    with suppress(UnknownType):
        return message_class(types[0]) if len(types) == 1 else None
    return None
