"""The window's server as a process: its start, its end, and its ports."""

import json
import signal
import socket
import sys
import threading
from contextlib import closing

import pytest
from fixtures.says import assert_line, assert_says
from fixtures.window import LivePage
from websockets.exceptions import ConnectionClosed

from lcmtools.bus.url import parse_url
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.access import access_for
from lcmtools.gui.server import Server
from lcmtools.gui.source import BusSource
from lcmtools.observe.reading.monitor import BusMonitor


def test_ctrl_c_tells_all_pages_and_ends(start, lcmtools_path, bus_url):
    program = start(
        lcmtools_path, "gui", "--port", "0", "--no-open", "--json", LCM_DEFAULT_URL=bus_url
    )
    program.wait_for("}")
    address = json.loads(program.output)["command"]
    with LivePage(address) as page:
        program.send_signal(signal.SIGINT)
        with pytest.raises(ConnectionClosed) as caught:
            page.until(lambda _: False)
        assert caught.value.rcvd is not None
        assert caught.value.rcvd.code == 1001
    assert program.wait() == 128 + signal.SIGINT


def test_a_signal_waits_for_the_step_that_the_server_does(bus_url):
    """Within asyncio, an interrupt can leave a connection half closed, which never ends."""
    done = []

    def start(port):
        signal.raise_signal(signal.SIGINT)
        done.append(port)

    before = signal.getsignal(signal.SIGINT)
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor, closing(BusSource(monitor)) as bus:
        server = Server(bus, access_for(None), {}, lambda _: None)
        with pytest.raises(KeyboardInterrupt):
            server.run_until_interrupted("127.0.0.1", 0, start)
    assert len(done) == 1
    assert signal.getsignal(signal.SIGINT) is before


def test_a_server_on_a_thread_ends_with_its_block_and_raises_where_it_begins(bus_url):
    with BusMonitor(parse_url(bus_url), "gui", {}) as monitor, closing(BusSource(monitor)) as bus:
        server = Server(bus, access_for(None), {}, lambda _: None)
        with server.serving("127.0.0.1", 0) as port:
            with (
                pytest.raises(LcmtoolsError, match=f"port {port} is in use"),
                server.serving("127.0.0.1", port),
            ):
                pass
            assert LivePage(f"http://127.0.0.1:{port}/").hello["source"] == "bus"
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", port))
    assert "pages" not in {thread.name for thread in threading.enumerate()}


def test_a_port_in_use_is_an_error_with_the_next_step(cli, bus_url):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        result = cli("gui", "--port", str(port), "--no-open", "--lcm-url", bus_url)
    assert (result.code, result.out) == (1, "")
    parts = (f"port {port}", "in use; ", f"http://127.0.0.1:{port}; ", f"--port {port + 1}\n")
    assert_line(result.err, "lcmtools gui all: ", *parts)


def test_an_address_of_another_computer_is_an_error(cli, bus_url):
    result = cli("gui", "--host", "192.0.2.1", "--port", "0", "--no-open", "--lcm-url", bus_url)
    assert (result.code, result.err.count("\n")) == (1, 1)
    assert_says(result.err, "lcmtools gui all: ", "cannot listen", "192.0.2.1: ")


def test_the_extra_is_named_where_it_is_missing(cli, bus_url, monkeypatch):
    monkeypatch.delitem(sys.modules, "lcmtools.gui.server", raising=False)
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    result = cli("gui", "topics", "--lcm-url", bus_url)
    assert (result.code, result.out, result.err.count("\n")) == (3, "", 1)
    assert "pip install 'lcmtools-robotics[web]'" in result.err


def test_a_recording_is_finished_and_reported_when_the_server_ends(
    start, lcmtools_path, bus_url, tmp_path
):
    words = ("--json", "--record-directory", str(tmp_path), "--lcm-url", bus_url)
    program = start(lcmtools_path, "gui", "--port", "0", "--no-open", *words)
    program.wait_for("}")
    with LivePage(json.loads(program.output)["command"]) as page:
        assert "answer" in page.request("do", "record", topics=[])
        program.send_signal(signal.SIGTERM)
        program.wait_for(f"recorded 0 messages (0 B) in {tmp_path}/")
    assert program.wait() == 128 + signal.SIGTERM
    assert len(list(tmp_path.glob("*.lcmlog"))) == 1
