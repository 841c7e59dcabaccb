"""The damaged parts of a log: bytes that belong to no message."""

from dataclasses import dataclass

from lcmtools.bag.summary_report import time_text
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reports.describe import size_text


@dataclass(frozen=True, slots=True)
class Damage:
    """A range of bytes that belong to no message; times are nanoseconds since 1970."""

    start: int  # the first byte
    end: int  # after the last one
    after: int | None  # time of the message before; None if there is none
    before: int | None  # time of the message after

    def to_json(self) -> dict[str, object]:
        """Return the range for JSON."""
        names = ("start", "end", "after", "before")
        return {name: getattr(self, name) for name in names}

    def __str__(self) -> str:
        """Return the range as text."""
        size = size_text(self.end - self.start)
        where = f"{size} do not belong to any message: bytes {self.start} to {self.end - 1}"
        after = f"after {time_text(self.after)}" if self.after is not None else "at the start"
        return f"{where}, {after}{'' if self.before is not None else ', to the end'}"


def find_damage(log: LogFile) -> list[Damage]:
    """Return the damaged parts of a log."""
    found: list[Damage] = []
    end, time = 0, None
    for event in log.events():
        if event.start > end:
            found.append(Damage(end, event.start, time, event.time))
        end, time = event.end, event.time
    if end < log.size:
        found.append(Damage(end, log.size, time, None))
    return found


def damage_rows(damage: list[Damage]) -> list[str]:
    """Return a line for each part, and one for the total."""
    total = sum(part.end - part.start for part in damage)
    rows = [f"left out: {part}" for part in damage]
    return [*rows, f"left out in total: {size_text(total)}"] if len(rows) > 1 else rows
