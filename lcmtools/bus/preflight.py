"""Checks, before liblcm or Zenoh is called, for conditions that make it hang, crash or print.

Must not import lcm or zenoh.
"""

import socket
import time
from collections.abc import Callable
from pathlib import Path

from lcmtools.bus.multicast import check_multicast, check_route
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.folders import opened
from lcmtools.wire.log_events import SYNC

_CONNECT_TIMEOUT = 3.5  # [s]; TCP retransmits lost packets of it after 1 s and 3 s
_ANSWER_TIMEOUT = 5.0  # [s]; a busy server may take its time
_PERIOD = 0.2  # [s] between two checks


def check_bus(url: BusUrl) -> None:
    """Make sure that the bus can be used. This takes some seconds if a server does not answer.

    Raises:
        BusError: It cannot; the error says what to do.
    """
    if url.provider in ("udpm", "mpudpm"):
        if url.provider == "mpudpm":  # liblcm does not send over loopback instead
            check_route(url)
        check_multicast(url)
    elif url.provider == "tcpq":
        _check_server(url)
    elif url.provider == "zenoh":
        from lcmtools.bus.zenoh.check import check_place  # most buses are not Zenoh

        check_place(url.place)
    elif url.provider == "file":
        _check_log(url)


def wait_for_bus(url: BusUrl, notify: Callable[[str], None]) -> None:
    """Wait until the bus can be used, because nodes may start before the computer's network is up.

    Calls ``notify`` with the first problem.
    """
    if problem := _problem(url):
        notify(f"waiting for the bus: {problem}")
        while _problem(url):
            time.sleep(_PERIOD)


def _problem(url: BusUrl) -> BusError | None:
    try:
        check_bus(url)
    except BusError as error:
        return error
    return None


def _check_server(url: BusUrl) -> None:
    """Check that the server answers: liblcm waits for a silent one forever, and blocks Python."""
    from lcmtools.wire.tcpq import CLIENT_GREETING, SERVER_GREETING

    try:
        with socket.create_connection((url.host, url.port), _CONNECT_TIMEOUT) as server:
            server.settimeout(_ANSWER_TIMEOUT)
            server.sendall(CLIENT_GREETING)
            if server.makefile("rb").read(len(SERVER_GREETING)) != SERVER_GREETING:
                raise ConnectionError(0, "another program listens there")
    except OSError as error:
        hint = f"start one there: lcmtools relay --serve {url}"
        if isinstance(error, socket.gaierror):
            hint = f"see whether the name is right: ping {url.host}"
        what = f"no LCM server at {url.host}:{url.port} ({error.strerror or 'no answer'})"
        raise BusError(what, hint) from error


def _check_log(url: BusUrl) -> None:
    path = Path(url.network)
    if url.options.get("mode", "r") != "r":
        if path.exists() and not path.is_file():
            raise BusError(f"cannot write the log '{path}': it is not a file")
        return
    with opened(path, f"cannot read the log '{path}'", BusError) as log:
        start = log.read(len(SYNC))
    if start != SYNC:
        raise BusError(f"'{url.network}' is empty or not an LCM log")
