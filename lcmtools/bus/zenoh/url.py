"""Zenoh URLs: which programs a session finds, and where it listens. Only text.

    zenoh://                       all programs of this computer, which find each other
    zenoh://HOST:7447,HOST2:7447   through a router or program there: the first that answers
    zenoh://224.0.0.224:7450       all programs that look for others at this multicast group
    zenoh:///etc/zenoh.json5       as a configuration file of Zenoh says

Options: ``prefix`` of the keys; ``listen``, an address at which others may connect; ``interface``,
the network on which to look for others, and whose programs may connect; ``patience``, the seconds
after which a program that does not read is disconnected.
"""

import re
from collections.abc import Mapping
from ipaddress import AddressValueError, IPv4Address
from typing import NamedTuple

from lcmtools.bus.zenoh.keys import DEFAULT_PREFIX, Keys, is_legal_prefix
from lcmtools.errors import InvalidUrl

DEFAULT_PORT = 7447  # the port of Zenoh's routers
SCOUTING_GROUP = "224.0.0.224:7446"  # the multicast group at which Zenoh programs look for others
OPTIONS = ("prefix", "listen", "interface", "patience")
LOOPBACK = "loopback"
_DIGITS = 4  # at most in a sensible number of seconds

_ADDRESS = re.compile(r"(?P<host>\[[0-9a-fA-F:.]+\]|[^:\[\]/\s]+)(?::(?P<port>\d{1,5}))?")
_EXAMPLE = f"write 'zenoh://', 'zenoh://HOST:{DEFAULT_PORT}' or 'zenoh:///path/to/config.json5'"


class Address(NamedTuple):
    """A host and a TCP port."""

    host: str
    port: int

    @property
    def is_multicast(self) -> bool:
        """True for a multicast group."""
        try:
            return IPv4Address(self.host).is_multicast
        except AddressValueError:
            return False

    def __str__(self) -> str:
        """Return both as they are written in a URL."""
        return f"{self.host}:{self.port}"


class ZenohPlace(NamedTuple):
    """The parts of a Zenoh URL."""

    hosts: tuple[Address, ...] = ()  # the routers or programs to connect to; () to look for others
    group: str = SCOUTING_GROUP  # the multicast group at which to look for others
    file: str = ""  # the configuration file, which replaces all the others; "" for none
    listen: Address | None = None  # another address at which others may connect; None for none
    # The network on which to look for others; "loopback" for this computer only.
    interface: str = LOOPBACK
    keys: Keys = Keys()  # the keys of the channels
    patience: int = 1  # the time [s] that a program which does not read may hold up others

    @property
    def is_client(self) -> bool:
        """True if everything goes through one of the hosts, and nothing listens here."""
        return bool(self.hosts) and self.listen is None

    @property
    def is_remote(self) -> bool:
        """True if other computers may take part."""
        return bool(self.hosts or self.listen or self.file) or self.interface != LOOPBACK


def parse_place(where: str, network: str, options: Mapping[str, str]) -> ZenohPlace:
    """Read the parts of a URL; ``where`` is the URL and its source, for errors.

    Raises:
        InvalidUrl: It is wrong; the error shows the right form.
    """
    prefix = options.get("prefix", DEFAULT_PREFIX)
    if not is_legal_prefix(prefix):
        hint = "prefixes are letters, digits and '_.~-', in parts with '/' between"
        raise InvalidUrl(f"{where}: '{prefix}' is not a prefix of Zenoh keys", hint)
    place = ZenohPlace(
        listen=_address(where, options["listen"]) if "listen" in options else None,
        interface=options.get("interface", LOOPBACK),
        keys=Keys(prefix),
        patience=_seconds(where, options.get("patience", "1")),
    )
    if network.startswith("/"):
        return place._replace(file=network)
    hosts = tuple(_address(where, part) for part in network.split(",")) if network else ()
    if len(hosts) == 1 and hosts[0].is_multicast:
        return place._replace(group=str(hosts[0]))
    return place._replace(hosts=hosts)


def locator_address(locator: str) -> Address | None:
    """Return the host and port of a Zenoh locator ("tls/robot:7447"); None if it has none."""
    found = _ADDRESS.fullmatch(re.split("[?#]", locator)[0].partition("/")[2])
    return Address(found["host"], int(found["port"] or DEFAULT_PORT)) if found else None


def _seconds(where: str, text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= _DIGITS and int(text)):
        raise InvalidUrl(f"{where}: patience={text} is not a number of seconds", "write patience=1")
    return int(text)


def _address(where: str, text: str) -> Address:
    found = _ADDRESS.fullmatch(text)
    if not found:
        raise InvalidUrl(f"{where}: '{text}' is not a host and port", _EXAMPLE)
    port = int(found["port"] or DEFAULT_PORT)
    if not 0 < port < 65536:  # noqa: PLR2004 - TCP
        raise InvalidUrl(f"{where}: '{port}' is not a port", f"ports are 1 to 65535; {_EXAMPLE}")
    return Address(found["host"], port)
