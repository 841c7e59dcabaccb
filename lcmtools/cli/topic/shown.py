"""How ``lcmtools echo`` shows a packet: which part of the message, if at all, and in what form."""

import csv
import io
import json
from dataclasses import dataclass
from typing import Literal, cast

from lcmtools.cli.output import talk
from lcmtools.cli.topic.payload import Decoder, raw_record, raw_text
from lcmtools.errors import UnknownType, UsageError
from lcmtools.messages.filter import Filter
from lcmtools.messages.header import stamp
from lcmtools.messages.path import Path, parse_path, select, target
from lcmtools.messages.plain import Plain, plain_json
from lcmtools.messages.registry import Message, message_class
from lcmtools.messages.text import format_message
from lcmtools.messages.view import (
    Hidden,
    Scalar,
    columns,
    format_flow,
    format_plain,
    plain_selection,
)
from lcmtools.wire.packet import Packet

Form = Literal["text", "json", "csv", "flow", "raw", "raw json"]


@dataclass(frozen=True, slots=True)
class Look:
    """What was asked for.

    Attributes:
        form: How a message is written.
        fields: The parts to show, from where the topic's own path ends; none for all of it.
        condition: Which messages are shown; None for all.
        hidden: What is not shown of them.
    """

    form: Form
    fields: tuple[Path, ...]
    condition: Filter | None
    hidden: Hidden

    def paths(self, behind_topic: Path) -> tuple[Path, ...]:
        """All parts to show, from the message on."""
        return tuple(behind_topic.then(field) for field in self.fields) or (behind_topic,)

    def check(self, types: tuple[str, ...], behind_topic: Path) -> None:
        """Find unknown fields before a message has come, where one type is announced.

        Raises:
            UsageError: There are such fields, or parts of bytes that are not decoded are wanted.
        """
        if self.form.startswith("raw") and any(path.steps for path in self.paths(behind_topic)):
            raise UsageError("--raw shows whole messages", "leave out the field, or --raw")
        if len(types) == 1:
            try:
                cls = message_class(types[0])
            except UnknownType:
                return
            self._check_class(cls, behind_topic)

    def _check_class(self, cls: type[Message], behind_topic: Path) -> None:
        for path in self.paths(behind_topic):
            target(cls, path)
        if self.condition:
            self.condition.check(cls)


def look(
    form_flags: dict[str, bool], fields: tuple[str, ...], condition: str | None, hidden: Hidden
) -> Look:
    """What the command line asks for.

    Args:
        form_flags: Whether each of --json, --csv, --flow-style and --raw was given.
        fields: The --field options.
        condition: The --filter option.
        hidden: What is not to be shown.

    Raises:
        UsageError: Something is wrong, or two options exclude each other.
    """
    given = [option for option, is_given in form_flags.items() if is_given]
    if len(given) > 1 and given != ["--json", "--raw"]:
        raise UsageError(f"{' and '.join(given)} exclude each other", f"leave out {given[-1]}")
    if "--raw" in given and hidden:
        raise UsageError("--raw shows whole messages", "leave out --noarr and --nostr")
    form = "raw json" if len(given) > 1 else _FORMS[given[0]] if given else "text"
    parsed = tuple(parse_path(field) for field in fields)
    return Look(form, parsed, Filter(condition) if condition is not None else None, hidden)


_FORMS: dict[str, Form] = {"--json": "json", "--csv": "csv", "--flow-style": "flow", "--raw": "raw"}


class Shower:
    """Turns packets into what is printed."""

    def __init__(self, decoder: Decoder, what: Look) -> None:
        self._decoder = decoder
        self._look = what
        self._table = Table()
        self._has_told = False

    def show(self, packet: Packet, behind_topic: Path) -> str | None:
        """The text of a packet; None for one that does not meet the condition or has no fields.

        Raises:
            ValueMismatch: The message has no such field, or the filter cannot be worked out.
        """
        paths, form = self._look.paths(behind_topic), self._look.form
        message: Message | str = ""
        if form not in ("raw", "raw json") or self._look.condition:
            message = self._decoder.decode(packet)
            if isinstance(message, str):
                return self._undecoded(packet, message, paths)
            if self._look.condition and not self._look.condition.matches(message):
                return None
        if form == "raw":
            return packet.payload.hex()
        if form == "raw json":
            return json.dumps(raw_record(packet))
        return self._text(packet, cast("Message", message), paths)

    def _text(self, packet: Packet, message: Message, paths: tuple[Path, ...]) -> str:
        form = self._look.form
        if form == "text" and paths == (Path(),) and not self._look.hidden:
            return f"{format_message(message)}\n---"
        plain = self._plain(message, paths)
        if form == "json":
            return plain_json(plain)
        if form == "csv":
            return self._table.rows(_time(packet, message), plain)
        return f"{format_flow(plain) if form == 'flow' else format_plain(plain)}\n---"

    def _plain(self, message: Message, paths: tuple[Path, ...]) -> Plain:
        """One part of a message; or several, by their paths."""
        hidden = self._look.hidden
        if len(paths) == 1:
            return plain_selection(select(message, paths[0]), hidden)
        return {str(path): plain_selection(select(message, path), hidden) for path in paths}

    def _undecoded(self, packet: Packet, reason: str, paths: tuple[Path, ...]) -> str | None:
        whole = paths == (Path(),) and not self._look.condition
        if whole and self._look.form == "json":
            record = raw_record(packet)
            return json.dumps({"bytes": record["bytes"], "error": reason, "data": record["data"]})
        if whole and self._look.form in ("text", "flow"):
            return f"{raw_text(packet, reason)}\n---"
        if not self._has_told:
            self._has_told = True
            talk(f"lcmtools echo: a message on {packet.channel} has no known fields: {reason}")
        return None


class Table:
    """Rows of comma-separated values under the columns of the first one."""

    def __init__(self) -> None:
        self._columns: list[str] = []
        self._has_told = False

    def rows(self, time: int, plain: Plain) -> str:
        """The row of a message, after the line with the columns' names if it is the first.

        A column that a message does not have is empty; values without a column are left out, which
        is said once.
        """
        cells: dict[str, Scalar] = {"%time": time, **columns(plain)}
        head = "" if self._columns else f"{_row(list(cells))}\n"
        self._columns = self._columns or list(cells)
        more = len(cells.keys() - set(self._columns))
        if more and not self._has_told:
            self._has_told = True
            talk(
                f"lcmtools echo: no column for {more} more in an array that was shorter in the"
                " first message; --field with a slice gives all rows the same columns"
            )
        return head + _row([cells.get(column, "") for column in self._columns])


def _row(cells: "list[str] | list[Scalar]") -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(cells)
    return text.getvalue()


def _time(packet: Packet, message: Message) -> int:
    """The header's stamp, else the arrival, nanoseconds since 1970."""
    stamped = stamp(message)
    return packet.time if stamped is None else stamped
