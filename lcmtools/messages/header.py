"""The header that many messages begin with.

Belongs here: what a std_msgs/Header says of the message that it is in. Must not know the wire.
"""

from lcmtools.messages.registry import Message, type_name


def stamp(message: Message) -> int | None:
    """A message's stamp [ns since 1970]; None when it has no ``header``."""
    header = getattr(message, "header", None)
    if header is None or type_name(header) != "std_msgs/Header":
        return None
    return int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nsec)
