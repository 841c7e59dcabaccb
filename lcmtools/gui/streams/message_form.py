"""Publishing the message in a page's form once, or repeatedly while a stream is open."""

import threading
import time
from typing import Annotated

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.typed import Within
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, publishers_of, topic_to_publish
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.gui.type_forms import filled_in
from lcmtools.publish.schedule import due_times

_LOWEST, _HIGHEST = 0.01, 200.0  # [Hz]
_STANDSTILL = 1.0  # [s] behind the schedule after which nobody expects more messages


class FilledForm:
    """A message from a form, ready to be published on its topic.

    Raises:
        UnknownType: There is no such type.
        ValueMismatch: A value does not fit its field.
        UsageError: The topic's name is empty or invalid.
        LcmtoolsError: Nothing can be published here.
    """

    def __init__(self, source: Source, topic: str, kind: str, values: Json) -> None:
        self._publishers = publishers_of(source)
        self._topic = topic_to_publish(source, topic)
        self._template = filled_in(kind, values)

    def send(self) -> None:
        """Publish it, after setting the times of sending; BusError if the bus refuses it."""
        payload = self._template.payload(time.time_ns())
        self._publishers.publish(self._topic, type(self._template.message), payload)


def publish(source: Source, *, topic: str, type: str, values: Json) -> Json:  # noqa: A002 - the key of a request
    """Publish a form's message once."""
    FilledForm(source, topic, type, values).send()
    return None


class RepeatedForm(PageStream):
    """Publishes ``values`` of ``type`` on ``topic`` at ``rate`` [Hz]; ends with the page."""

    period = 0.25
    commands = True

    def __init__(
        self,
        source: Source,
        *,
        topic: str,
        type: str,  # noqa: A002 - the key of a request
        values: Json,
        rate: Annotated[float, Within(_LOWEST, _HIGHEST)] = 1.0,
    ) -> None:
        super().__init__(source)
        self._rate = rate
        self._form = FilledForm(source, topic, type, values)
        self._count = self._said = 0
        self._fault = ""
        self._over = threading.Event()
        self.until_closed(self._over.set)
        threading.Thread(target=self._publish, name="publishing", daemon=True).start()

    def update(self) -> Update | None:
        """Return the number of published messages."""
        if self._count == self._said:
            return None
        self._said = self._count
        return Update({"count": self._count})

    def problem(self) -> str:
        """Return why the last one was not published."""
        return self._fault

    def _publish(self) -> None:
        for due in due_times(self._rate):
            if self._over.wait(max(0.0, due - time.monotonic())):
                return
            behind = time.monotonic() - due
            if behind > _STANDSTILL:
                self._fault = f"stopped: the server stood still for {behind:.0f} s"
                return
            self._fault = self._send()
            self._count += not self._fault

    def _send(self) -> str:
        """Publish once; return the reason if that failed, else ""."""
        try:
            self._form.send()
        except LcmtoolsError as error:
            return str(error)
        return ""
