"""The simulator's window is a process of its own, which ends with the simulator."""

import signal
import urllib.request
from collections.abc import Callable
from contextlib import suppress
from typing import Any
from urllib.error import URLError

import pytest

pytest.importorskip("pybullet")
pytest.importorskip("websockets")
pytestmark = pytest.mark.usefixtures("quiet_network")  # of its usual port


def is_there(address: str) -> bool:
    """Return if a page is served."""
    with suppress(URLError, OSError), urllib.request.urlopen(address) as answer:  # noqa: S310
        return b"<title>lcmtools</title>" in answer.read()
    return False


@pytest.mark.parametrize("word", ["--view", "--gui"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_the_window_is_opened_and_ends_with_the_simulator(
    start: Callable[..., Any],
    lcmtools_path: str,
    bus_url: str,
    wait_until: Callable[..., None],
    word: str,
    number: signal.Signals,
) -> None:
    simulator = start(
        lcmtools_path, "run", "sim", word, "--lcm-url", bus_url, DISPLAY="", WAYLAND_DISPLAY=""
    )
    address = simulator.wait_for("http://").split()[-1]
    assert is_there(address)

    simulator.send_signal(number)

    simulator.wait()
    wait_until(lambda: not is_there(address))


def test_where_it_cannot_be_opened_the_reason_is_said_and_the_simulator_goes_on(
    start: Callable[..., Any], lcmtools_path: str, bus_url: str
) -> None:
    words = ("run", "sim", "empty", "--view", "--lcm-url", bus_url)
    first = start(lcmtools_path, *words, DISPLAY="", WAYLAND_DISPLAY="")
    first.wait_for("http://")
    second = start(lcmtools_path, *words, "__name:=other", DISPLAY="", WAYLAND_DISPLAY="")

    assert "port 7680 is in use" in second.wait_for("lcmtools gui")
    second.send_signal(signal.SIGINT)
    assert second.wait() == 0
