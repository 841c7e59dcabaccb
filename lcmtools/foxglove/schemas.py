"""Types and messages as Foxglove reads them: in ROS 1's format if possible, else as JSON."""

import json

from lcmtools.bag.ros_types import RosTypes, Schema
from lcmtools.errors import DecodeError, LcmtoolsError, ValueMismatch, needing_extra
from lcmtools.messages.fill import fill
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import Message, type_name

ROS1, JSON = "ros1", "json"
ENCODINGS = (JSON, ROS1)  # of clients' messages, the preferred one first


class Schemas:
    """Conversion of LCM types and messages to Foxglove's, and back; MissingExtra if it cannot."""

    def __init__(self) -> None:
        with needing_extra("foxglove", "foxglove needs"):  # it also has ROS's types
            self._types = RosTypes(1)
        self._found: dict[type[Message], tuple[str, Schema]] = {}

    def of(self, cls: type[Message]) -> tuple[str, Schema]:
        """Return the encoding of a type's messages, and the schema."""
        if cls not in self._found:
            try:
                self._found[cls] = ROS1, self._types.schema(cls)
            except LcmtoolsError:
                name = type_name(cls)
                schema = json.dumps({"title": name, "type": "object"}).encode()
                self._found[cls] = JSON, Schema(name, "jsonschema", schema)
        return self._found[cls]

    def write(self, message: Message) -> bytes:
        """Return a message in the encoding of its type."""
        encoding, _ = self.of(type(message))
        return self._types.serialize(message) if encoding == ROS1 else to_json(message).encode()

    def read(self, cls: type[Message], encoding: str, data: bytes) -> Message:
        """Return a client's message; DecodeError if it has another type or encoding."""
        if encoding == ROS1:
            return self._types.deserialize(cls, data)
        if encoding != JSON:
            raise DecodeError(f"messages in '{encoding}'", f"known: {', '.join(ENCODINGS)}")
        message = cls()
        try:
            fill(message, json.loads(data))
        except (ValueError, ValueMismatch) as error:
            raise DecodeError(f"no {type_name(cls)}: {error}") from error
        return message
