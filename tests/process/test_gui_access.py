"""The right to open the window and to command: addresses, tokens, origins, malformed requests."""

import gzip
import socket
from http import HTTPStatus
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest
from fixtures.says import assert_says
from fixtures.window import LivePage
from websockets.exceptions import ConnectionClosed, InvalidStatus

from lcmtools.gui.access import HEADERS
from lcmtools.gui.protocol import LONGEST_REQUEST
from lcmtools.gui.server import STATIC
from lcmtools.gui.static_files import StaticFiles


@pytest.mark.parametrize(
    "path", ["/", "/main.js", "/panels/topics.js", "/none", "/socket", "/%2e%2e/server.py"]
)
def test_every_answer_keeps_others_out(open_window, path):
    window = open_window()
    response = window.get(path)
    assert response.status == {"/none": 404, "/%2e%2e/server.py": 404, "/socket": 403}.get(
        path, 200
    )
    assert {name: response.getheader(name) for name in HEADERS} == HEADERS
    assert response.getheader("Server") is None
    refused = window.get(path, Host="evil.example")
    assert (refused.status, refused.getheader("X-Frame-Options")) == (403, "DENY")


@pytest.mark.parametrize(
    ("accepted", "encoding"),
    [
        ("gzip, deflate, br", "gzip"),
        ("br;q=1.0, GZIP;q=0.5", "gzip"),
        ("*", "gzip"),
        ("identity", None),
        ("gzip;q=0, *", None),
        ("*; q=0.0", None),
        ("", None),
    ],
)
def test_files_are_compressed_for_browsers_that_accept_it(open_window, accepted, encoding):
    window = open_window()
    plain = (STATIC / "style.css").read_bytes()
    response = window.get("/style.css", **{"Accept-Encoding": accepted})
    body = response.read()
    assert response.getheader("Content-Encoding") == encoding
    assert response.getheader("Vary") == "Accept-Encoding"
    assert (gzip.decompress(body) if encoding else body) == plain
    assert (len(body) < len(plain) / 2) is bool(encoding)
    tag = response.getheader("ETag") or ""
    again = window.get("/style.css", **{"Accept-Encoding": accepted, "If-None-Match": tag})
    assert (again.status, again.read()) == (304, b"")
    other = {"Accept-Encoding": "identity" if encoding else "gzip", "If-None-Match": tag}
    assert window.get("/style.css", **other).status == 200


def test_a_file_is_compressed_once(tmp_path, monkeypatch):
    (tmp_path / "index.html").write_text("hello")
    files = StaticFiles(tmp_path)
    first = files.get("/", "gzip")
    monkeypatch.delattr(gzip, "compress")
    assert files.get("/", "gzip") is first
    assert files.get("/none", "gzip") is None


def test_no_file_outside_of_the_page_is_served(open_window):
    window = open_window()
    for path in (
        "/../server.py",
        "//etc/passwd",
        "//[",
        "/panels/../../server.py",
        "/panels/",
        "/x\0.js",
    ):
        with socket.create_connection(("127.0.0.1", window.port)) as raw:
            raw.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
            assert raw.recv(15) == b"HTTP/1.1 404 No", path


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "http://127.0.0.1:1"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": None}, 403),
        ({"Host": "evil.example", "Origin": "http://evil.example"}, 403),
    ],
)
def test_a_page_of_others_gets_no_connection(open_window, headers, status):
    window = open_window()
    with pytest.raises(InvalidStatus) as caught:
        window.page(**headers)
    assert caught.value.response.status_code == status
    with window.page() as page:  # while its own is served
        assert page.hello["rights"] == ["watch", "command"]


def test_it_listens_on_this_computer_alone(open_window):
    window = open_window()
    with pytest.raises(ConnectionRefusedError):  # as any other address of this computer
        socket.create_connection(("127.0.0.2", window.port)).close()


def test_a_token_gives_the_right_to_watch_or_to_command(open_window):
    window = open_window("0.0.0.0")  # noqa: S104 - that is what is tested
    form = {"topic": "/a", "type": "std_msgs/String", "values": {"data": "x"}}
    assert window.get("/").status == 403
    assert window.get("/?token=" + "x" * 22).status == 403
    with pytest.raises(InvalidStatus):
        LivePage(f"http://127.0.0.1:{window.port}/?token=x")
    with window.page("watch") as page:
        assert page.hello["rights"] == ["watch"]
        page.open(1, "topics")
        assert_says(page.request("do", "publish", **form)["error"]["what"], "only watch")
        page.open(2, "publishing", rate=10, **form)
        assert_says(page.problem(2), "only watch")
    with window.page("command") as page:
        assert page.request("do", "publish", **form)["answer"] is None


@pytest.mark.parametrize(
    "rubbish",
    [
        "{",
        b"\0\1",
        "[]",
        '{"op": "explode"}',
        '{"op": "open", "id": 1, "stream": "none"}',
        '{"op": "ask", "id": 1, "what": "x"}',
    ],
)
def test_rubbish_closes_its_page_and_no_other_and_is_told_once(open_window, rubbish, wait_until):
    window = open_window()
    with window.page() as other:
        for _ in range(2):
            with window.page() as page:
                page.socket.send(rubbish)
                with pytest.raises(ConnectionClosed) as caught:
                    page.until(lambda _: False)
            assert caught.value.rcvd is not None
            assert caught.value.rcvd.code == 1008
        assert "answer" in other.request("ask", "types")
    wait_until(lambda: window.told)
    assert len(window.told) == 1
    assert window.told[0].startswith("a page was closed: ")


def test_rubbish_behind_open_streams_closes_its_page_too(open_window):
    window = open_window()
    for _ in range(10):  # in the turn in which the first stream wakes what writes
        with window.page() as page:
            page.open(1, "topics")
            page.open(2, "none")
            with pytest.raises(ConnectionClosed):
                page.until(lambda _: False)


def test_a_message_that_is_too_long_closes_its_page(open_window):
    window = open_window()
    with window.page() as page:
        page.socket.send("x" * (LONGEST_REQUEST + 1))
        with pytest.raises(ConnectionClosed) as caught:
            page.until(lambda _: False)
        assert caught.value.rcvd is not None
        assert caught.value.rcvd.code == 1009


@pytest.mark.parametrize("words", [(), ("--read-only",), ("--no-token",)])
def test_this_computers_address_has_a_token_unless_nobody_wants_one(
    start, lcmtools_path, bus_url, words
):
    window = start(lcmtools_path, "gui", *words, "--port", "0", "--no-open", "--lcm-url", bus_url)
    _, address = window.wait_for("http://").split()
    assert ("?token=" in address) == ("--no-token" not in words)
    bare = address.partition("?")[0]
    for opened, is_open in ((address, True), (bare, "--no-token" in words)):
        connection = HTTPConnection(urlsplit(opened).netloc, timeout=40)
        connection.request("GET", opened.removeprefix(bare.rstrip("/")))
        assert (connection.getresponse().status == HTTPStatus.OK) == is_open
        connection.close()
    if "--no-token" not in words:
        with pytest.raises(InvalidStatus):
            LivePage(bare)
    with LivePage(address) as page:
        assert ("command" in page.hello["rights"]) == ("--read-only" not in words)


def test_two_addresses_are_told_where_others_may_watch(cli, bus_url):
    arguments = ("--host", "127.0.0.2", "--port", "0", "--no-open", "--lcm-url", bus_url)
    result = cli("gui", *arguments, until="Ctrl-C ends it")
    watch, command, _ = result.err.splitlines()
    assert watch.startswith("open http://127.0.0.2:")
    assert command.startswith("open http://127.0.0.2:")
    assert watch.endswith(" to watch")
    assert command.endswith(" to command")
    assert watch.partition("?token=")[2].split()[0] != command.partition("?token=")[2].split()[0]
