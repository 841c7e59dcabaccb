"""Reasons why a Zenoh session cannot open, which Zenoh itself does not report.

Must not import Zenoh.
"""

import contextlib
import errno
import socket
from pathlib import Path

from lcmtools.bus.zenoh.url import DEFAULT_PORT, Address, ZenohPlace
from lcmtools.errors import BusError, os_errors_as
from lcmtools.folders import read_bytes, read_text

_TIMEOUT = 0.8  # [s]
_PAGE = "docs/networks.md shows a configuration file"


def check_place(place: ZenohPlace) -> None:
    """Make sure that a session can be opened there. This takes under a second.

    Raises:
        BusError: It cannot; the error says what to do.
    """
    if place.file:
        what = f"cannot read Zenoh's configuration '{place.file}'"
        read_bytes(Path(place.file), what=what, kind=BusError)
        return
    if place.listen:
        _check_listening(place.listen)
    if place.hosts:
        _check_hosts(place.hosts)


def refusal(address: Address, user: str, certificate: str | None) -> BusError:
    """Return the likely reason why no session opens with a host that can be reached.

    ``user`` is the user name of the session, "" for none; ``certificate`` is the file of trusted
    certificates, "" for the system's, None for a connection without TLS.
    """
    if certificate is not None and (trouble := _tls_trouble(address, certificate)):
        return trouble
    if certificate is None and _speaks_tls(address):
        return BusError(f"{address} wants TLS", _PAGE)
    if user:
        what = f"{address} rejects the user '{user}' or the password, or is not a Zenoh router"
        return BusError(what, "both are in the configuration file, and in the router's dictionary")
    hint = f"it is not a Zenoh router, or it wants a user and a password: {_PAGE}"
    return BusError(f"{address} answers, but rejects this program", hint)


def _check_listening(address: Address) -> None:
    family = socket.AF_INET6 if address.host.startswith("[") else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address.host.strip("[]"), address.port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:  # another program of this bus listens there
                return
            hint = f"name an address of this computer, or 0.0.0.0:{address.port} for all"
            raise BusError(f"cannot listen at {address} ({error.strerror})", hint) from error


def _check_hosts(hosts: tuple[Address, ...]) -> None:
    for address in hosts:
        fault = _fault(address)
        if fault is None:
            return
    where = " or ".join(map(str, hosts))
    listening = f"'zenoh://?listen=0.0.0.0:{hosts[0].port}'"
    hint = f"start a router there (zenohd), or a program with --lcm-url {listening}"
    if isinstance(fault, socket.gaierror):
        hint = f"see whether the name is right: ping {hosts[-1].host}"
    reason = (fault and fault.strerror) or "no answer"
    raise BusError(f"no Zenoh router or program at {where} ({reason})", hint) from fault


def _fault(address: Address) -> OSError | None:
    try:
        _connect(address).close()
    except OSError as error:
        return error
    return None


def _connect(address: Address) -> socket.socket:
    host = address.host.strip("[]")
    return socket.create_connection((host, address.port or DEFAULT_PORT), timeout=_TIMEOUT)


def _speaks_tls(address: Address) -> bool:
    import ssl  # late: it takes 15 ms

    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    with contextlib.suppress(OSError), _connect(address) as plain:
        context.wrap_socket(plain).close()
        return True
    return False


def _tls_trouble(address: Address, certificate: str) -> BusError | None:
    import ssl

    what = f"cannot read the certificate '{certificate}'"
    trusted = read_text(Path(certificate), what=what, kind=BusError) if certificate else None
    with os_errors_as(what, kind=BusError):
        context = ssl.create_default_context(cadata=trusted)
    context.verify_flags &= ~ssl.VERIFY_X509_STRICT  # Python 3.13 is stricter than Zenoh
    try:
        with _connect(address) as plain:
            context.wrap_socket(plain, server_hostname=address.host.strip("[]")).close()
    except ssl.SSLCertVerificationError as error:
        hint = "'root_ca_certificate' in the configuration names its authority's file"
        what = f"the certificate of {address} is not trusted ({error.verify_message})"
        return BusError(what, hint)
    except OSError as error:
        return BusError(f"{address} does not speak TLS ({error.strerror or error})", _PAGE)
    return None
