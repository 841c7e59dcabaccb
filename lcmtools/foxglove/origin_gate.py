"""A listener before the package's server, which itself lets in the pages of any website.

A browser states in the header Origin whose page connects, and no page can choose that. Programs
that are no browsers send none. The server behind has an address that no page can guess.
"""

import asyncio
import os
import re
import socket
import threading
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, closing, suppress

from lcmtools.errors import BusError, UsageError

_MOST_BYTES = 1 << 18  # of a request's head, and of what is passed on at a time
_PATIENCE = 10.0  # [s] for a request's head
_BUFFER_BYTES = 1 << 20  # that wait for a slow client here; others wait, and are dropped, behind
_LOST = (OSError, EOFError, asyncio.TimeoutError, asyncio.LimitOverrunError)
_ORIGIN = re.compile(r"null|file://|[a-z][a-z0-9+.-]*://[a-z0-9._:\[\]-]+", re.ASCII)


def parse_origin(text: str) -> str:
    """Return an origin, as browsers state it; UsageError if it is none."""
    origin = text.strip().casefold()
    if not origin.endswith("://"):
        origin = origin.rstrip("/")
    if not _ORIGIN.fullmatch(origin):
        hint = "write the beginning of the page's address: https://app.foxglove.dev"
        raise UsageError(f"'{text}' is not an origin", hint)
    return origin


class OriginGate(AbstractContextManager["OriginGate"]):
    """Passes connections to an inner server on, except those of foreign pages.

    Args:
        address: The host and port to listen at; port 0 for any.
        inner: Those of the server behind.
        allowed: The origins of pages that may connect, from ``parse_origin``.
        refuse: Called with the origin of a page that may not, on another thread.

    Raises:
        BusError: The address cannot be used.
    """

    def __init__(
        self,
        address: tuple[str, int],
        inner: tuple[str, int],
        allowed: Iterable[str],
        refuse: Callable[[str], None],
    ) -> None:
        self._inner, self._allowed, self._refuse = inner, frozenset(allowed), refuse
        self._socket = _listening(address)
        self._loop = asyncio.new_event_loop()
        self._task = self._loop.create_task(self._serve())
        self._thread = threading.Thread(target=self._run, name="foxglove gate")
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        """End all connections."""
        self._loop.call_soon_threadsafe(self._task.cancel)
        self._thread.join()

    @property
    def port(self) -> int:
        """The port on which it listens."""
        return int(self._socket.getsockname()[1])

    def _run(self) -> None:
        with closing(self._loop), suppress(asyncio.CancelledError):
            self._loop.run_until_complete(self._task)

    async def _serve(self) -> None:
        tasks: set[asyncio.Task[None]] = set()

        def begin(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            task = asyncio.ensure_future(self._pass_on(reader, writer))
            tasks.add(task)
            task.add_done_callback(tasks.discard)

        server = await asyncio.start_server(begin, sock=self._socket, limit=_MOST_BYTES)
        try:
            await asyncio.Event().wait()  # serve_forever() waits for the connections' ends
        finally:
            server.close()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _pass_on(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with closing(writer), suppress(*_LOST):
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), _PATIENCE)
            if foreign := [one for one in _origins(head) if one not in self._allowed]:
                if _ORIGIN.fullmatch(foreign[0]):  # else no browser has sent it
                    self._refuse(foreign[0])
                writer.write(b"HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\n\r\n")
                return
            await self._join(head, reader, writer)

    async def _join(
        self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        """Pass bytes on both ways, until one side ends."""
        behind = socket.create_connection(self._inner)
        behind.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        inner_reader, inner_writer = await asyncio.open_connection(sock=behind, limit=_MOST_BYTES)
        with closing(inner_writer):
            inner_writer.write(head)
            both = [
                asyncio.ensure_future(_copy(reader, inner_writer)),
                asyncio.ensure_future(_copy(inner_reader, writer)),
            ]
            try:
                await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for one in both:
                    one.cancel()
                await asyncio.gather(*both, return_exceptions=True)


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(_MOST_BYTES):
        writer.write(data)
        await writer.drain()


def _origins(head: bytes) -> list[str]:
    """Return the origins that a request states."""
    lines = (line.partition(":") for line in head.decode("latin-1").split("\n")[1:])
    return [v.strip().casefold() for name, _, v in lines if name.strip().casefold() == "origin"]


def _listening(address: tuple[str, int]) -> socket.socket:
    host, port = address
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server(address, family=family)
    except OSError as error:
        number = error.errno or 0  # negative ones are of looking a name up
        reason = os.strerror(number) if number > 0 else error.strerror
        what = f"cannot listen at {host}:{port}: {reason}"
        raise BusError(what, "--port N chooses another port") from error
