"""Access: who may open a page, what it may do, and the headers that keep others out.

Pure: headers and paths come in as text. A browser sends any website's requests to this computer, so
neither the address on which the server listens nor a missing password keeps a website out. The
names in the headers Host and Origin do, because a website cannot choose them. Tokens keep other
people out, also those with an account on this computer.
"""

import ipaddress
import secrets
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from hmac import compare_digest
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' blob: data:; connect-src 'self'; font-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""Headers of every answer."""
WATCH, COMMAND, PLAY = "watch", "command", "play"
LOCAL = ("127.0.0.1", "localhost", "::1")


class Refused(Exception):  # noqa: N818 - named for what happened
    """A refused request, with the status and the reason as a sentence."""

    def __init__(self, status: HTTPStatus, reason: str) -> None:
        super().__init__(reason)
        self.status, self.reason = status, reason


@dataclass(frozen=True, slots=True)
class Access:
    """The rules of one server."""

    names: frozenset[str]  # allowed in the header Host, without port
    any_address: bool = False  # True if it may be any IP address: no website can take one over
    tokens: Mapping[str, str] | None = None  # the token of each right; none if not needed
    is_read_only: bool = False  # True if nobody may command

    def rights(self, host: str, target: str) -> tuple[str, ...]:
        """Return the rights for ``target`` (path and query) at ``host``; Refused for none."""
        self.check_host(host)
        every = (WATCH,) if self.is_read_only else (WATCH, COMMAND)
        if not self.tokens:
            return every
        given = parse_qs(urlsplit(target).query).get("token", [""])[0]
        if COMMAND in every and _is(given, self.tokens[COMMAND]):
            return every
        if any(_is(given, token) for token in self.tokens.values()):
            return (WATCH,)
        reason = "This window needs the token in its address: lcmtools gui has printed it."
        raise Refused(HTTPStatus.FORBIDDEN, reason)

    def addresses(self, host: str, port: int) -> dict[str, str]:
        """Return the address to open for each right: only to watch, and also to command."""
        host = f"[{host}]" if ":" in host else host
        start = f"http://{host}:{port}/"
        if self.tokens:
            return {right: f"{start}?token={token}" for right, token in self.tokens.items()}
        return {WATCH if self.is_read_only else COMMAND: start}

    def check_host(self, host: str) -> None:
        """Raise Refused for a host name that is not this server's: a website's that points here."""
        name = _host_name(host)
        if name in self.names or (self.any_address and _is_address(name)):
            return
        raise Refused(HTTPStatus.FORBIDDEN, "This server does not answer to that name.")

    def check_origin(self, host: str, origin: str | None) -> None:
        """Raise Refused for a connection by another server's page, or without an origin."""
        if origin is None or origin.casefold() not in (f"http://{host}", f"https://{host}"):
            raise Refused(HTTPStatus.FORBIDDEN, "This server answers its own pages only.")


def access_for(
    address: str | None,
    own_names: Iterable[str] = (),
    *,
    is_read_only: bool = False,
    own_token: Callable[[str], str] | None = None,
) -> Access:
    """Return the rules for a server that others can reach at an address, or only this computer.

    With ``is_read_only`` nobody may command. ``own_token`` returns the token of a right on this
    computer; None if its users need none.
    """
    if address is None or address in LOCAL:
        right = WATCH if is_read_only else COMMAND
        own = {right: own_token(right)} if own_token else None
        return Access(frozenset(LOCAL), tokens=own, is_read_only=is_read_only)
    rights = (WATCH,) if is_read_only else (WATCH, COMMAND)
    tokens = {right: secrets.token_urlsafe(16) for right in rights}
    names = {*LOCAL, address.casefold(), *(name.casefold() for name in own_names)}
    is_any = _is_address(address) and ipaddress.ip_address(address).is_unspecified
    return Access(frozenset(names), is_any, tokens, is_read_only)


def _is(given: str, token: str) -> bool:
    return compare_digest(given.encode(), token.encode())


def _host_name(host: str) -> str:
    """Return the name in a header Host, without port; "" if it is invalid."""
    try:
        return (urlsplit(f"//{host}").hostname or "").casefold()
    except ValueError:
        return ""


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
