"""The classes that lcm-gen makes: of messages, and of a service's pair."""

from typing import ClassVar, Protocol


class Message(Protocol):
    """The interface of every class made by lcm-gen.

    The tables have one entry a field, in wire order: its name, its LCM type (nested types as
    ``module.Name``) and its array sizes (numbers, or names of length fields), None for no array.
    """

    __slots__: ClassVar[list[str]]
    __typenames__: ClassVar[list[str]]
    __dimensions__: ClassVar[list[list[int | str] | None]]

    def encode(self) -> bytes:
        """The payload, as lcm-gen's code makes it; ``codec.encode`` is the safe way."""

    def get_hash(self) -> int:
        """The fingerprint, unsigned 64-bit."""


class ServiceType(Protocol):
    """A pair of message types, like lcmtools.types.std_srvs.Trigger: asked and answered."""

    Request: type[Message]
    Response: type[Message]
