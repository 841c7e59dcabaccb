"""The evidence in the reports of relays."""

from lcmtools.doctor.evidence import RelayEnd
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode
from lcmtools.types.lcmtools_msgs import RelayLink, RelayReport


class RelayReports:
    """The reports that come during a look: of each relay the first and the last."""

    def __init__(self) -> None:
        self._found: dict[str, tuple[RelayLink, RelayLink]] = {}

    def take(self, payload: bytes) -> None:
        """Take note of a report, which tells of other relays too."""
        try:
            links = decode(RelayReport, payload).links
        except DecodeError:
            return
        for link in links:
            first, last = self._found.get(link.id, (link, link))
            self._found[link.id] = first, link if link.number > last.number else last

    def ends(self) -> tuple[RelayEnd, ...]:
        """Return both ends of each relay that has not left."""
        return tuple(
            RelayEnd(
                *(last.name, last.host, end.bus, end.trouble, end.dropped - before.dropped),
                commands=tuple(end.commands),
                stands_by=last.state == RelayLink.STANDBY,
            )
            for first, last in self._found.values()
            if last.state != RelayLink.LEFT
            for before, end in zip(first.ends, last.ends, strict=False)
        )
