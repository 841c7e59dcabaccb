"""The options of ``lcmtools echo``: which part of a message is shown, and in what form."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from lcmtools.errors import UnknownType, UsageError
from lcmtools.messages.fields import MessageClass
from lcmtools.messages.filter import Filter
from lcmtools.messages.path import Path, parse_path, target
from lcmtools.messages.plain import NOTHING, View
from lcmtools.messages.registry import Message, message_class
from lcmtools.messages.text import FREE, Writer

Form = Literal["text", "json", "csv", "flow", "raw", "raw json"]

_FORMS: dict[str, Form] = {"--json": "json", "--csv": "csv", "--flow-style": "flow", "--raw": "raw"}


@dataclass(frozen=True, slots=True)
class DisplayOptions:
    """The form and the parts of messages that are shown.

    Attributes:
        form: How a message is written.
        fields: The parts to show, from where the topic's own path ends; none for all of it.
        condition: Which messages are shown; None for all.
        view: What is shown otherwise than it is.
        writer: How numbers are written in text.
        is_relative: Points in time are shown relative to the message's arrival.
        message_class: What the messages are said to be; None where their fingerprints tell.
    """

    form: Form = "text"
    fields: tuple[Path, ...] = ()
    condition: Filter | None = None
    view: View = NOTHING
    writer: Writer = FREE
    is_relative: bool = False
    message_class: MessageClass | None = None

    @property
    def is_raw(self) -> bool:
        """True if payloads are shown as they are."""
        return self.form in ("raw", "raw json")

    def paths(self, behind_topic: Path) -> tuple[Path, ...]:
        """Return all parts to show, from the message on."""
        paths = tuple(behind_topic.then(field) for field in self.fields) or (behind_topic,)
        if self.is_raw and any(path.steps for path in paths):
            raise UsageError("--raw shows whole messages", "leave out the field, or --raw")
        return paths

    def is_whole(self, paths: tuple[Path, ...]) -> bool:
        """Return whether all of a message is shown, as it is."""
        is_as_it_is = not self.view and not self.is_relative and self.writer == FREE
        return is_as_it_is and paths == (Path(),)

    def check(self, types: tuple[str, ...], behind_topic: Path) -> None:
        """Find unknown fields before a message has come, where one type is announced."""
        paths = self.paths(behind_topic)
        cls = self.message_class or _announced_class(types)
        if cls is None:
            return
        for path in paths:
            target(cls, path)
        if self.condition:
            self.condition.check(cls)


def display_options(
    form_flags: Mapping[str, bool],
    fields: tuple[str, ...],
    condition: str | None,
    others: Mapping[str, bool],
) -> DisplayOptions:
    """Return what the command line asks for; the view and the like are not in it yet.

    Args:
        form_flags: Whether each of --json, --csv, --flow-style and --raw was given.
        fields: The --field options.
        condition: The --filter option.
        others: Whether each of the options was given that change how values are shown.
    """
    given = [option for option, is_given in form_flags.items() if is_given]
    if len(given) > 1 and given != ["--json", "--raw"]:
        raise UsageError(f"{' and '.join(given)} exclude each other", f"leave out {given[-1]}")
    changes = [option for option, is_given in others.items() if is_given]
    if "--raw" in given and changes:
        raise UsageError("--raw shows whole messages", f"leave out {' and '.join(changes)}")
    if "-w" in changes and given and given != ["--flow-style"]:
        raise UsageError(f"-w and {given[0]} exclude each other", f"leave out {given[0]} or -w")
    form = "raw json" if len(given) > 1 else _FORMS[given[0]] if given else "text"
    parsed = tuple(parse_path(field) for field in fields)
    return DisplayOptions(form, parsed, Filter(condition) if condition is not None else None)


def _announced_class(types: tuple[str, ...]) -> type[Message] | None:
    """The class of the one type that is announced; None for none, several, or one not known."""
    if len(types) != 1:
        return None
    try:
        return message_class(types[0])
    except UnknownType:
        return None
