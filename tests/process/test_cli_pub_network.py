"""pub while the network is gone: who repeats goes on, who was to send so many fails."""

import signal
from collections.abc import Callable
from typing import Any

import pytest

ROUTE = ("224.0.0.0/4", "dev", "lo")
MESSAGE = ("/chatter", "std_msgs/String", "hello")
CANNOT = "lcmtools pub: cannot publish on /chatter: Network is unreachable"
WAITING = f"{CANNOT}; waiting for the network"

pytestmark = pytest.mark.usefixtures("private_network")


def test_a_pub_that_repeats_goes_on_when_the_network_is_back(
    start: Callable[..., Any],
    lcmtools_path: str,
    bus_url: str,
    ip: Callable[..., None],
    wait_until: Callable[..., None],
) -> None:
    bus = {"LCM_DEFAULT_URL": bus_url}
    echo = start(lcmtools_path, "echo", "/chatter", **bus)
    pub = start(lcmtools_path, "pub", "-r", "50", *MESSAGE, **bus)
    echo.wait_for("hello")
    ip("route", "del", *ROUTE)
    pub.wait_for(WAITING)
    heard = len(echo.lines)
    ip("route", "add", *ROUTE)
    pub.wait_for("lcmtools pub: messages leave again")
    wait_until(lambda: len(echo.lines) > heard + 10)
    pub.send_signal(signal.SIGINT)
    assert pub.wait() == 130
    assert pub.lines.count(WAITING) == 1


def test_a_pub_of_so_many_fails(
    start: Callable[..., Any], lcmtools_path: str, bus_url: str, ip: Callable[..., None]
) -> None:
    pub = start(
        *(lcmtools_path, "pub", "-v", "-r", "50", "-t", "100000", *MESSAGE),
        LCM_DEFAULT_URL=bus_url,
    )
    pub.wait_for("publishing #2")
    ip("route", "del", *ROUTE)
    assert pub.wait() == 1
    assert pub.lines[-1] == CANNOT


def test_once_fails_with_one_line(
    start: Callable[..., Any], lcmtools_path: str, bus_url: str, ip: Callable[..., None]
) -> None:
    ip("route", "del", *ROUTE)
    pub = start(lcmtools_path, "pub", "-1", *MESSAGE, LCM_DEFAULT_URL=bus_url)
    assert pub.wait() == 1
    (line,) = pub.lines
    assert line.startswith("lcmtools pub: no multicast route to 239.255.76.67")
