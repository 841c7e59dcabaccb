"""How ``lcmtools echo`` shows a message."""

import json
from dataclasses import replace
from typing import cast

from lcmtools.cli.output import talk
from lcmtools.cli.topic.csv_rows import Table
from lcmtools.cli.topic.look import Look
from lcmtools.errors import DecodeError, ValueMismatch
from lcmtools.messages.cells import Cell, cells
from lcmtools.messages.header import stamp
from lcmtools.messages.path import Path, Selection, select
from lcmtools.messages.plain import Plain, plain_json
from lcmtools.messages.registry import Message
from lcmtools.messages.text import format_message
from lcmtools.messages.view import View, plain_selection
from lcmtools.observe.decoding import Decoder, UnknownFingerprint, remedy_of_unknown
from lcmtools.observe.stream import Match
from lcmtools.wire.packet import Packet

_SHOWN_BYTES = 64


class Shower:
    """Turns messages into what is printed."""

    def __init__(self, decoder: Decoder, what: Look) -> None:
        self._decoder = decoder
        self._look = what
        self._table = Table()
        self._told: set[str] = set()
        self._has_shown = False

    def show(self, match: Match) -> str | None:
        """The text of a message; None for one that is not to be shown or has no fields.

        A message that has not what is asked for is passed over, which is said once, where others
        have it or may have it.

        Raises:
            ValueMismatch: It is the first and has no such field, or the filter cannot be worked
                out.
        """
        try:
            text = self._shown(match)
        except ValueMismatch as mismatch:
            if not (match.is_one_of_many or self._has_shown):
                raise
            channel = match.packet.channel
            self._tell(f"unfit {channel}", f"a message on {channel} is left out: {mismatch}")
            return None
        self._has_shown = self._has_shown or text is not None
        return text

    def _shown(self, match: Match) -> str | None:
        paths, packet = self._look.paths(match.path), match.packet
        condition = self._look.condition
        message: Message | None = None
        if condition or not self._look.is_raw:
            try:
                message = self._decoder.decode(packet)
            except DecodeError as reason:
                return self._undecoded(match, reason)
            if condition and not condition.matches(message):
                return None
        if self._look.is_raw:
            return self._raw(match)
        return self._text(match, cast("Message", message), paths)

    def _text(self, match: Match, message: Message, paths: tuple[Path, ...]) -> str | None:
        form = self._look.form
        if form == "text" and self._look.is_whole(paths):
            return self._headed(match, f"{format_message(message)}\n---")
        found = {str(path): select(message, path) for path in paths}
        plain = _plain(found, self._view(match))
        if form == "json":
            return self._record(match, plain)
        if form == "csv":
            row = self._row(match, message, plain)
            return self._table.row(row, ", ".join(map(_kind, found.values())))
        writer = self._look.writer
        text = writer.flow(plain) if form == "flow" else writer.block(plain)
        return self._headed(match, f"{text}\n---")

    def _view(self, match: Match) -> View:
        view = self._look.view
        return replace(view, origin=match.time) if self._look.is_relative else view

    def _row(self, match: Match, message: Message, plain: Plain) -> dict[str, Cell]:
        """The cells of a row: the header's stamp, else the arrival, and the values."""
        stamped = stamp(message)
        time = match.time if stamped is None else stamped
        topic: dict[str, Cell] = {"topic": match.packet.channel} if match.is_one_of_many else {}
        origin = match.time if self._look.is_relative else 0
        return {"%time": time - origin, **topic, **cells(plain)}

    def _record(self, match: Match, plain: Plain) -> str:
        if not match.is_one_of_many:
            return plain_json(plain)
        return plain_json({"topic": match.packet.channel, "message": plain})

    def _raw(self, match: Match) -> str:
        if self._look.form == "raw json":
            return _raw_record(match, {})
        return self._headed(match, match.packet.payload.hex())

    def _headed(self, match: Match, text: str) -> str:
        """A text under its topic, as a comment in YAML, where there may be several."""
        return f"# {_one_line(match.packet.channel)}\n{text}" if match.is_one_of_many else text

    def _undecoded(self, match: Match, reason: DecodeError) -> str | None:
        packet = match.packet
        channel = packet.channel
        paths = self._look.paths(match.path)
        is_all = paths == (Path(),) and not self._look.condition
        if is_all and self._look.form == "json":
            return _raw_record(match, {"error": str(reason)})
        is_unknown = isinstance(reason, UnknownFingerprint)
        if is_all and self._look.form in ("text", "flow"):
            if is_unknown and not self._told:
                self._tell("unknown", f"no type is known for {channel}; {remedy_of_unknown()}")
            return self._headed(match, f"{_raw_text(packet, str(reason))}\n---")
        what = f"{reason}; {remedy_of_unknown()}" if is_unknown and not self._told else str(reason)
        self._tell(f"raw {channel}", f"a message on {channel} has no known fields: {what}")
        return None

    def _tell(self, about: str, text: str) -> None:
        if about not in self._told:
            self._told.add(about)
            talk(f"lcmtools echo: {text}")


def _plain(found: dict[str, Selection], view: View) -> Plain:
    """One part of a message; or several, by their paths."""
    if len(found) == 1:
        return plain_selection(next(iter(found.values())), view)
    return {path: plain_selection(selection, view) for path, selection in found.items()}


def _one_line(channel: str) -> str:
    """A channel's name without what would end the comment, or colour the terminal."""
    return channel if channel.isprintable() else ascii(channel)


def _kind(selection: Selection) -> str:
    """What a selected value is: a type, with a pair of brackets for each array around it."""
    return selection.target.type + "[]" * selection.target.depth


def _raw_text(packet: Packet, reason: str) -> str:
    """A payload that cannot be decoded, as YAML all the same."""
    shown = packet.payload[:_SHOWN_BYTES].hex(" ")
    more = " ..." if len(packet.payload) > _SHOWN_BYTES else ""
    return f"# {reason}\nbytes: {len(packet.payload)}\ndata: '{shown}{more}'"


def _raw_record(match: Match, more: dict[str, object]) -> str:
    topic = {"topic": match.packet.channel} if match.is_one_of_many else {}
    packet = match.packet
    content = {"bytes": len(packet.payload), **more, "data": packet.payload.hex()}
    return json.dumps({**topic, **content})
