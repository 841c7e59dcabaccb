"""A server of tcpq is reached although the network loses what asks for a connection."""

import socket
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from lcmtools.bus.preflight import check_bus
from lcmtools.bus.url import parse_url
from lcmtools.wire.tcpq import CLIENT_GREETING, SERVER_GREETING

_COUNTERS = Path("/proc/net/netstat")


def _turned_away():
    """The number of attempts to connect that were dropped, as by a full line."""
    names, values = (line.split() for line in _COUNTERS.read_text().splitlines()[:2])
    return int(values[names.index("ListenOverflows")])


@pytest.mark.skipif(not _COUNTERS.exists(), reason="counts as Linux does")
def test_a_lost_attempt_to_connect_is_made_again(wait_until):
    with socket.create_server(("127.0.0.1", 0), backlog=0) as server, ThreadPoolExecutor(1) as pool:
        server.settimeout(40.0)
        address = server.getsockname()
        before = _turned_away()
        with socket.create_connection(address):  # the only one that may wait
            checked = pool.submit(check_bus, parse_url(f"tcpq://127.0.0.1:{address[1]}"))
            wait_until(lambda: _turned_away() > before)
            server.accept()[0].close()
            client, _ = server.accept()
        with client:
            assert client.recv(len(CLIENT_GREETING)) == CLIENT_GREETING
            client.sendall(SERVER_GREETING)
        checked.result(40.0)
