"""Publishing what a page's form says."""

import time

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json, Parameters
from lcmtools.gui.source import Source
from lcmtools.gui.types import filled_in
from lcmtools.names import resolve
from lcmtools.publish.publication import check_topic


class FilledForm:
    """A message of a form, ready to be published on its topic.

    Raises:
        UnknownType: There is no such type.
        ValueMismatch: A value does not fit its field.
        UsageError: The topic's name is empty, or no name.
        LcmtoolsError: Nothing can be published here.
    """

    def __init__(self, source: Source, parameters: Parameters) -> None:
        if source.publishers is None:
            raise LcmtoolsError("a log takes no messages", "open the window on a bus")
        self._publishers = source.publishers
        self._topic = _channel(source, parameters.text("topic"))
        self._template = filled_in(parameters)

    def send(self) -> None:
        """Publish it; times that are to be the moment of sending are set.

        Raises:
            BusError: The bus cannot be reached, or does not take it.
        """
        payload = self._template.payload(time.time_ns())
        self._publishers.publish(self._topic, type(self._template.message), payload)


def publish(source: Source, parameters: Parameters) -> Json:
    """Publish a form's message once."""
    FilledForm(source, parameters).send()
    return None


def _channel(source: Source, topic: str) -> str:
    """A topic by its name as it is where it is on the bus, else by the rules of ROS."""
    is_known = any(row.channel == topic for row in source.latest.rows)
    check_topic(topic, literal=is_known)
    return topic if is_known else resolve(topic)
