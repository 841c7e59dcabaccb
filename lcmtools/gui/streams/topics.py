"""The stream of the topics: for each the record of ``spy --json``, and if it is silent."""

from typing import cast

from lcmtools.gui.protocol import Json, Parameters
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.observe.channels.channel_report import record


class Topics(PageStream):
    """All topics of the source except hidden ones."""

    period = 0.25
    is_shared = True

    def __init__(self, source: Source, parameters: Parameters) -> None:
        super().__init__(source, parameters)
        self.until_closed(source.listen_to_all())

    def update(self) -> Update:
        """Return the current rows."""
        latest = self.source.latest
        data: dict[str, Json] = {
            "rows": [cast("Json", {**record(row), "silent": row.is_silent}) for row in latest.rows],
            "programs": latest.plain_listeners,
            "errors": latest.callback_errors,
        }
        return Update(data)

    def problem(self) -> str:
        """Return a sentence if there are no topics yet."""
        return "" if self.source.latest.rows else "there are no topics on the bus"
