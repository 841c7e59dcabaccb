"""The stream that publishes a form's message again and again while it is open."""

import threading
import time

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.forms import FilledForm
from lcmtools.gui.protocol import Parameters
from lcmtools.gui.source import Source
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.publish.schedule import due_times

_LOWEST, _HIGHEST = 0.01, 200.0  # [Hz]


class RepeatedForm(PageStream):
    """Publishes ``values`` of ``type`` on ``topic`` at ``rate`` [Hz]; ends with the page."""

    period = 0.25
    commands = True

    def __init__(self, source: Source, parameters: Parameters) -> None:
        super().__init__(source, parameters)
        self._rate = parameters.number("rate", 1.0, _LOWEST, _HIGHEST)
        self._form = FilledForm(source, parameters)
        self._count = self._said = 0
        self._fault = ""
        self._over = threading.Event()
        self.until_closed(self._over.set)
        threading.Thread(target=self._publish, name="publishing", daemon=True).start()

    def update(self) -> Update | None:
        """Return how many have been published."""
        if self._count == self._said:
            return None
        self._said = self._count
        return Update({"count": self._count})

    def problem(self) -> str:
        """Return why the last one was not published."""
        return self._fault

    def _publish(self) -> None:
        due = due_times(self._rate)
        while not self._over.wait(max(0.0, next(due) - time.monotonic())):
            self._fault = self._send()
            self._count += not self._fault

    def _send(self) -> str:
        """Publish once; return why it was not, "" if it was."""
        try:
            self._form.send()
        except LcmtoolsError as error:
            return str(error)
        return ""
