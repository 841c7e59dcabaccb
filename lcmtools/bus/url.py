"""LCM URLs, read as liblcm reads them, Zenoh URLs, and the choice of the bus.

Only text. Stricter than liblcm in one way: a group without a port is an error, whereas liblcm uses
port 0 and hangs for ten seconds.
"""

from collections.abc import Iterator, Mapping, Sequence
from ipaddress import AddressValueError, IPv4Address
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from lcmtools.errors import InvalidUrl, UsageError
from lcmtools.names import did_you_mean
from lcmtools.settings import NO_FILE, UserFile

if TYPE_CHECKING:  # other buses do not need it
    from lcmtools.bus.zenoh.url import ZenohPlace

DEFAULT_GROUP = "239.255.76.67"
DEFAULT_PORT = 7667
DEFAULT_SERVER = "127.0.0.1"
SERVER_PORT = 7700
MAX_DOMAIN = 232  # the largest domain, as in ROS 2; ports stay below the ephemeral range

_DIGITS = 10  # at most in a sensible number in a URL; Python refuses to read thousands
_PROVIDERS = ("udpm", "mpudpm", "tcpq", "memq", "file", "zenoh")
_OPTIONS = {
    "udpm": ("ttl", "recv_buf_size", "transmit_only"),
    "mpudpm": ("ttl", "recv_buf_size", "nports"),
    "file": ("speed", "start_timestamp", "mode"),
}
_MAX_TTL = 255


class BusUrl(NamedTuple):
    """The URL of a bus."""

    provider: str  # "udpm", "mpudpm", "tcpq", "memq", "file" or "zenoh"
    network: str  # the part after "://", as written
    options: Mapping[str, str] = MappingProxyType({})  # the options after "?", as written
    host: str = ""  # multicast group (udpm, mpudpm) or server (tcpq); "" otherwise
    port: int = 0  # UDP or TCP port; 0 for memq, file and zenoh (see ``bus.zenoh.url``)

    @property
    def is_multicast(self) -> bool:
        """True if this bus is a UDP multicast group that the tap can observe."""
        return self.provider == "udpm"

    @property
    def place(self) -> "ZenohPlace":
        """The parts of a Zenoh URL."""
        from lcmtools.bus.zenoh.url import parse_place

        return parse_place(str(self), self.network, self.options)

    @property
    def file_name(self) -> str:
        """A name for files of this bus; if possible, the same for different URLs of one bus."""
        if self.provider != "zenoh":
            return f"{self.provider}-{self.host}-{self.port}"
        place = self.place
        where = place.file or ",".join(map(str, place.hosts)) or place.group
        return f"zenoh-{where}-{place.keys.prefix}".replace("/", "+")

    @property
    def ttl(self) -> int:
        """The hops that datagrams may travel; 0 stays on this host. liblcm keeps 8 bits."""
        return int(self.options.get("ttl", "0")) & 0xFF

    def with_option(self, key: str, value: str) -> "BusUrl":
        """Return the same bus with one more option, unless it is there already."""
        options = {key: value, **self.options}
        return BusUrl(self.provider, self.network, options, self.host, self.port)

    def __str__(self) -> str:
        """Return the URL as liblcm accepts it."""
        options = "&".join(f"{key}={value}" for key, value in self.options.items())
        network = f"{self.host}:{self.port}" if self.host else self.network
        return f"{self.provider}://{network}" + (f"?{options}" if options else "")


def choose_url(
    url: str | None, domain: str | None, environment: Mapping[str, str], file: UserFile = NO_FILE
) -> tuple[BusUrl, str]:
    """Return the chosen bus, and the source of the choice.

    In this order: the given URL ("--lcm-url"), the given domain ("--domain"), LCM_DEFAULT_URL,
    LCMTOOLS_DOMAIN, the URL and the domain in the user's file (its line), LCM's default
    ("default"). An empty value counts as not given, as in liblcm.

    Raises:
        InvalidUrl: The URL is wrong.
        UsageError: The domain is not a number from 0 to 232.
    """
    candidates = (
        (url, "--lcm-url", parse_url),
        (domain, "--domain", domain_url),
        (environment.get("LCM_DEFAULT_URL"), "LCM_DEFAULT_URL", parse_url),
        (environment.get("LCMTOOLS_DOMAIN"), "LCMTOOLS_DOMAIN", domain_url),
        (file.values.get("lcm_url"), "lcm_url", parse_url),
        (file.values.get("domain"), "domain", domain_url),
    )
    for value, source, read in candidates:
        if value:
            where = file.source(source) if source in file.values else source
            return read(value, where), where
    return domain_url("0", ""), "default"


def domain_url(domain: str, source: str = "domain") -> BusUrl:
    """Return the bus of a domain: LCM's default group, port 7667 + domain, staying on this host."""
    if not (_is_number(domain) and int(domain) <= MAX_DOMAIN):
        hint = f"a domain is a number from 0 to {MAX_DOMAIN}"
        raise UsageError(f"{source} '{domain}' is not a domain", hint)
    return parse_url(f"udpm://{DEFAULT_GROUP}:{DEFAULT_PORT + int(domain)}?ttl=0", source)


def another_domain(url: str) -> int:
    """Return a domain that is not the bus of a URL."""
    return 2 if f"{DEFAULT_GROUP}:{DEFAULT_PORT + 1}" in url else 1


def parse_url(text: str, source: str = "LCM URL") -> BusUrl:
    """Read an LCM URL (``provider://network?key=value&key=value``) from a source.

    Raises:
        InvalidUrl: It is wrong; the error shows the right form.
    """
    provider, separator, rest = text.partition("://")
    if not separator or provider not in _PROVIDERS:
        hint = did_you_mean(provider, _PROVIDERS) or f"write {_example()}"
        raise InvalidUrl(f"{source} '{text}': no LCM provider '{provider}'", hint)
    network, *option_parts = rest.split("?")
    pairs = (part.partition("=") for part in "&".join(option_parts).split("&") if part)
    options = {key: value for key, _, value in pairs}  # also unknown ones, which liblcm ignores
    where = f"{source} '{text}'"
    for key in ("ttl", "recv_buf_size", "nports"):
        if not _is_number(value := options.get(key, "0")):
            raise InvalidUrl(f"{where}: {key}={value} is not a number", f"write {_example()}")
    if provider in ("udpm", "mpudpm"):
        host, port = _parse_group(where, provider, network)
    elif provider == "tcpq":
        host, port = _parse_server(where, network)
    else:
        host, port = "", 0
    if provider == "zenoh":
        from lcmtools.bus.zenoh.url import parse_place

        parse_place(where, network, options)
    return BusUrl(provider, network, options, host, port)


def misread_options(url: BusUrl, source: str = "the URL") -> Iterator[str]:
    """Yield a sentence for each option that liblcm ignores or interprets differently.

    Unknown options are no error, because liblcm only warns of them.
    """
    known, where = _known_options(url.provider), f"{source} {url}"
    for key, value in url.options.items():
        if key not in known:
            options = f"the options {', '.join(known)}" if known else "no options"
            hint = did_you_mean(key, known) or f"{url.provider} has {options}"
            yield f"{where}: {key}={value} has no effect; {hint}"
        elif key == "ttl" and int(value) > _MAX_TTL:
            yield f"{where}: ttl={value} is sent as {url.ttl}; the maximum is {_MAX_TTL}"


def _known_options(provider: str) -> Sequence[str]:
    if provider == "zenoh":
        from lcmtools.bus.zenoh.url import OPTIONS

        return OPTIONS
    return _OPTIONS.get(provider, ())


def _parse_group(where: str, provider: str, network: str) -> tuple[str, int]:
    host, colon, port = (network or f"{DEFAULT_GROUP}:{DEFAULT_PORT}").rpartition(":")
    if not colon:
        raise InvalidUrl(f"{where}: the port is missing", f"write {_example(provider, network)}")
    number = _parse_port(where, port, _example(provider, host))
    try:
        multicast = IPv4Address(host).is_multicast
    except AddressValueError:
        multicast = False
    if not multicast:
        hint = f"groups are 224.0.0.0 to 239.255.255.255; write {_example(provider)}"
        raise InvalidUrl(f"{where}: {host or 'nothing'} is not a multicast address", hint)
    return host, number


def _parse_server(where: str, network: str) -> tuple[str, int]:
    # as in liblcm, both the server and its port may be missing
    if network.startswith("[") or network.count(":") > 1:
        hint = f"write the server's name or its IPv4 address: {_example('tcpq')}"
        raise InvalidUrl(f"{where}: LCM's tcpq has no IPv6", hint)
    host, colon, port = network.partition(":")
    example = _example("tcpq", host)
    return host or DEFAULT_SERVER, _parse_port(where, port, example) if colon else SERVER_PORT


def _parse_port(where: str, text: str, example: str) -> int:
    if not (_is_number(text) and 0 < int(text) < 65536):  # noqa: PLR2004 - UDP and TCP
        hint = f"ports are 1 to 65535; write {example}"
        raise InvalidUrl(f"{where}: '{text}' is not a port", hint)
    return int(text)


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < _DIGITS


def _example(provider: str = "udpm", host: str = "") -> str:
    if provider == "tcpq":
        return f"'tcpq://{host or DEFAULT_SERVER}:{SERVER_PORT}'"
    return f"'{provider}://{host or DEFAULT_GROUP}:{DEFAULT_PORT}?ttl=0'"
