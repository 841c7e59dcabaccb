"""The stream of the topics: for each the record of ``spy --json``, and if it is silent."""

from typing import cast

from lcmtools.gui.protocol import Json, Parameters
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.observe.channels.channel_report import record
from lcmtools.observe.channels.rows import ChannelRow


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
        return Update(
            {
                "rows": [_row(row) for row in latest.rows],
                "programs": latest.plain_listeners,
                "errors": latest.callback_errors,
            }
        )

    def problem(self) -> str:
        """Return a sentence if there are no topics yet."""
        return "" if self.source.latest.rows else "there are no topics on the bus"


def _row(row: ChannelRow) -> Json:
    return cast("Json", {**record(row), "silent": row.is_silent})
