"""The server: the static files and the pages' WebSockets, on one port.

Only this module knows the websockets package.
"""

import asyncio
import contextlib
import errno
import logging
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future
from http import HTTPStatus
from pathlib import Path

from websockets.asyncio.server import Server as WebSocketServer
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from lcmtools import __version__
from lcmtools.errors import LcmtoolsError
from lcmtools.gui.access import COMMAND, HEADERS, PLAY, Access, Refused
from lcmtools.gui.page import BrowserPage
from lcmtools.gui.protocol import LONGEST_REQUEST, SUBPROTOCOL, Json, MalformedRequest
from lcmtools.gui.source import Source
from lcmtools.gui.static_files import FileContent, StaticFiles
from lcmtools.gui.steering import SpeedLimits
from lcmtools.gui.streams.pool import StreamPool
from lcmtools.signals import ENDING, Doubles

STATIC = Path(__file__).parent / "static"
_MOST_PAGES = 100
_WAITING_BYTES = 1 << 16  # that are passed to the system before a stream waits
_POLICY_VIOLATION = 1008  # WebSocket close code (RFC 6455)
_CLOSE_TIMEOUT = 1.0  # [s] to wait for a page's answer when the server ends


_DESCRIPTORS = 4  # of an event loop and a server


class PortInUse(LcmtoolsError):  # noqa: N818 - named for what happened
    """Another program listens on the port."""


class Server:
    """A server for pages.

    ``view`` is the initial panel and its settings; empty for all panels. ``notify`` is called with
    sentences for the user, for example about a page that sends invalid requests.
    """

    def __init__(
        self,
        source: Source,
        access: Access,
        view: Mapping[str, Json],
        notify: Callable[[str], None],
    ) -> None:
        self._source, self._access, self._view, self._notify = source, access, view, notify
        self._streams = StreamPool(source)
        self._files = StaticFiles(STATIC)
        self._pages = 0
        self._said: set[str] = set()

    def run_until_interrupted(
        self, address: str, port: int, on_start: Callable[[int], None]
    ) -> None:
        """Serve until Ctrl-C, and close all pages before it takes effect; see ``run``."""
        with contextlib.closing(_new_loop()) as loop:
            task = loop.create_task(self.run(address, port, on_start))
            try:
                with (
                    _cancelled_by_signals(loop, task),
                    contextlib.suppress(asyncio.CancelledError),
                ):
                    loop.run_until_complete(task)
            finally:
                loop.run_until_complete(loop.shutdown_default_executor())

    @contextlib.contextmanager
    def serving(self, address: str, port: int) -> Iterator[int]:
        """Serve on a thread within the block, which gets the port; close all pages; see ``run``."""
        started: Future[int] = Future()
        with contextlib.closing(_new_loop()) as loop:
            task = loop.create_task(self.run(address, port, started.set_result))

            def serve_pages() -> None:
                try:
                    loop.run_until_complete(task)
                except asyncio.CancelledError:
                    loop.run_until_complete(loop.shutdown_default_executor())
                except Exception as error:
                    if started.done():
                        raise
                    started.set_exception(error)

            thread = threading.Thread(target=serve_pages, name="pages")
            thread.start()
            try:
                yield started.result()
            finally:
                loop.call_soon_threadsafe(task.cancel)
                thread.join()

    async def run(self, address: str, port: int, on_start: Callable[[int], None]) -> None:
        """Serve until it is cancelled; then close all pages.

        Args:
            address: The IP address to listen on.
            port: The TCP port; 0 for any free one.
            on_start: Called with the port once pages can be opened.

        Raises:
            PortInUse: Another program listens on the port.
            LcmtoolsError: The address is not this computer's.
        """
        try:
            server = await self._serve(address, port)
        except OSError as error:
            raise _port_error(error, address, port) from error
        try:
            async with server:
                on_start(int(next(iter(server.sockets)).getsockname()[1]))
                try:
                    await asyncio.Event().wait()
                finally:  # pages may go on to drive while they are being closed
                    if self._source.steering:
                        self._source.steering.close()
        finally:
            if self._source.publishers:
                self._source.publishers.end_calls()

    async def _serve(self, address: str, port: int) -> WebSocketServer:
        quiet = logging.getLogger("lcmtools.gui")
        quiet.addHandler(logging.NullHandler())
        quiet.propagate = False
        return await serve(
            self._serve_page,
            address,
            port,
            process_request=self._respond,
            subprotocols=[Subprotocol(SUBPROTOCOL)],
            compression=None,
            server_header=None,
            max_size=LONGEST_REQUEST,
            write_limit=_WAITING_BYTES,
            close_timeout=_CLOSE_TIMEOUT,
            logger=quiet,
        )

    def _respond(self, _: ServerConnection, request: Request) -> Response | None:
        """Answer a request; None to open a page's WebSocket."""
        try:
            return self._answer(request)
        except Refused as refused:
            return _response(refused.status, refused.reason.encode(), "text/plain")

    def _answer(self, request: Request) -> Response | None:
        host, path = _single_header(request, "Host") or "", request.path.partition("?")[0]
        self._access.check_host(host)
        if path == "/socket":
            self._access.check_origin(host, _single_header(request, "Origin"))
            self._access.rights(host, request.path)
            if self._pages >= _MOST_PAGES:
                raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, "Too many pages are open.")
            return None
        if path == "/":
            self._access.rights(host, request.path)
        file = self._files.get(path, ",".join(request.headers.get_all("Accept-Encoding")))
        if file is None:
            raise Refused(HTTPStatus.NOT_FOUND, "There is nothing at this address.")
        return _file_response(file, _single_header(request, "If-None-Match"))

    async def _serve_page(self, connection: ServerConnection) -> None:
        request = connection.request
        assert request is not None, "it has been answered"
        rights = self._access.rights(_single_header(request, "Host") or "", request.path)
        if self._source.kind == "log":  # the right to command a bus is the right to play a log
            rights = tuple(PLAY if one == COMMAND else one for one in rights)
        self._pages += 1
        try:
            page = BrowserPage(connection, self._source, self._streams, rights)
            await page.serve(self._hello(rights))
        except ConnectionClosed:
            pass
        except MalformedRequest as fault:
            self._say_once(f"a page was closed: {fault}")
            await connection.close(_POLICY_VIOLATION, str(fault)[:100])
        except Exception as error:  # noqa: BLE001 - reported; the other pages go on
            self._say_once(f"a fault of lcmtools ({type(error).__name__}: {error})")
        finally:
            self._pages -= 1

    def _hello(self, rights: tuple[str, ...]) -> Mapping[str, Json]:
        limits = self._source.steering.limits if self._source.steering else SpeedLimits()
        return {
            "version": __version__,
            "source": self._source.kind,
            "bus": self._source.name,
            "rights": rights,
            "limits": [limits.linear, limits.angular],
            "view": self._view,
        }

    def _say_once(self, text: str) -> None:
        if text not in self._said and len(self._said) < _MOST_PAGES:
            self._said.add(text)
            self._notify(text)


def _new_loop() -> asyncio.AbstractEventLoop:
    """Return a new event loop; OSError if there are too few descriptors for it and its server.

    asyncio would print a traceback, or serve on no socket.
    """
    held: list[int] = []
    try:
        for _ in range(_DESCRIPTORS):
            held.append(os.open(os.devnull, os.O_RDONLY))  # noqa: PERF401 - the others are closed
    finally:
        for descriptor in held:
            os.close(descriptor)
    return asyncio.new_event_loop()


@contextlib.contextmanager
def _cancelled_by_signals(
    loop: asyncio.AbstractEventLoop, task: "asyncio.Task[None]"
) -> Iterator[None]:
    """Let Ctrl-C and other signals that have handlers cancel a task, and come again afterwards.

    A KeyboardInterrupt raised anywhere in the loop may leave a connection half closed, and the
    server would wait forever for its end.
    """
    is_main = threading.current_thread() is threading.main_thread()
    handled = {n: now for n in ENDING if is_main and callable(now := signal.getsignal(n))}
    came: list[int] = []
    doubles = Doubles()

    def cancel(number: int) -> None:
        if not doubles.is_double():
            came.append(number)
            task.cancel()

    for number in handled:
        loop.add_signal_handler(number, cancel, number)
    try:
        yield
    finally:
        for number, handler in handled.items():
            loop.remove_signal_handler(number)
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])


def _single_header(request: Request, name: str) -> str | None:
    """Return the value of a header that occurs once."""
    values = request.headers.get_all(name)
    return values[0] if len(values) == 1 else None


def _file_response(file: FileContent, known: str | None) -> Response:
    is_known = known == file.tag
    status = HTTPStatus.NOT_MODIFIED if is_known else HTTPStatus.OK
    response = _response(status, b"" if is_known else file.body, file.kind)
    response.headers["ETag"] = file.tag
    response.headers["Vary"] = "Accept-Encoding"
    if file.encoding:
        response.headers["Content-Encoding"] = file.encoding
    return response


def _response(status: HTTPStatus, body: bytes, kind: str) -> Response:
    headers = Headers(HEADERS)
    headers["Content-Type"] = f"{kind}; charset=utf-8" if kind.startswith("text/") else kind
    headers["Content-Length"] = str(len(body))
    headers["Cache-Control"] = "no-cache"  # revalidate with the tag
    headers["Connection"] = "close"
    return Response(status.value, status.phrase, headers, body)


def _port_error(error: OSError, address: str, port: int) -> LcmtoolsError:
    if error.errno == errno.EADDRINUSE:
        hint = f"another window may be open at http://{address}:{port}"
        return PortInUse(f"port {port} is in use", f"{hint}; else choose: --port {port + 1}")
    if error.errno == errno.EACCES:
        hint = "choose one from 1024 on: --port 7680"
        return LcmtoolsError(f"port {port} is not permitted", hint)
    # asyncio replaces the system's message; negative numbers are name look-up errors
    number = error.errno or 0
    reason = os.strerror(number) if number > 0 else error.strerror or str(error)
    return LcmtoolsError(f"cannot listen on {address}: {reason}")
