"""Serving tcpq as a person attends it."""

import signal
from collections.abc import Sequence
from functools import partial
from ipaddress import ip_address
from typing import NoReturn

from lcmtools.bus.url import BusUrl
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError
from lcmtools.observe.describe import size_text
from lcmtools.relay.hub import Hub, HubCounts, serve


def attend_hub(url: BusUrl, line: StatusLine) -> NoReturn:
    """Serve tcpq until Ctrl-C; show what it does on a terminal, and say it in the end."""
    with Hub(url, line.talk) as hub:
        line.talk(f"serves tcpq://{url.host}:{hub.port} to {_audience(url.host)}")
        try:
            serve(hub, partial(_show, line), lambda: signal.raise_signal(signal.SIGTERM))
        finally:
            line.talk(_counted(hub.counts))


def _show(line: StatusLine, counts: HubCounts) -> None:
    if rates := line.rates(counts.messages, counts.bytes):
        clients = "1 client" if counts.clients == 1 else f"{counts.clients} clients"
        flow = f"{rates[0]:.0f} messages/s, {size_text(rates[1])}/s"
        line.write(f"{clients}; {flow}; {_dropped(counts)}")


def _counted(counts: HubCounts) -> str:
    return f"{counts.messages} messages ({size_text(counts.bytes)}); {_dropped(counts)}"


def _dropped(counts: HubCounts) -> str:
    return f"{counts.dropped} dropped for slow clients" if counts.dropped else "none dropped"


def _audience(host: str) -> str:
    """The programs that can connect to an address."""
    try:
        address = ip_address(host)
    except ValueError:
        return f"all who reach {host}"
    if address.is_loopback:
        return "programs of this computer"
    what = "all its addresses" if address.is_unspecified else host
    return f"all who reach this computer at {what}, without a password"


def check_server(url: BusUrl, buses: Sequence[str]) -> None:
    """Refuse to serve what cannot be served, or more than a server."""
    if buses:
        hint = f"start another relay that joins {url} and {buses[0]}"
        raise UsageError("--serve is a server and joins no bus", hint)
    if url.provider != "tcpq":
        raise UsageError(f"cannot serve {url}", "write --serve tcpq://:7700")
