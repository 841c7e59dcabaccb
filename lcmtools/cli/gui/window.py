"""The options of ``lcmtools gui``, and opening the window."""

import os
import socket
import webbrowser
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING

import click

from lcmtools.cli.bus import chosen_log, notify, open_monitor
from lcmtools.cli.declare import CommandT, flag, option, together
from lcmtools.cli.options import bag_option, bus_options, json_option, names_options
from lcmtools.cli.output import write_document, write_note
from lcmtools.errors import needing_extra

if TYPE_CHECKING:  # not needed for the help
    from lcmtools.gui.protocol import Json
    from lcmtools.gui.source import Source

PORT = 7680
_LAST_PORT = 65535


@dataclass(frozen=True, slots=True)
class WindowChoice:
    """The options of the window."""

    port: int
    host: str | None
    read_only: bool
    opens: bool | None  # the browser; None where there is a display
    as_json: bool


def _collected(command: click.Command) -> click.Command:
    """Combine the window's options into one value."""
    function = command.callback
    assert function is not None, "it is declared by a function"

    @wraps(function)
    def run(**values: object) -> object:
        chosen = {name: values.pop(name) for name in WindowChoice.__slots__}
        return function(WindowChoice(**chosen), **values)  # type: ignore[arg-type] # click's

    command.callback = run
    return command


window_options: Callable[[CommandT], CommandT] = together(
    option(
        "--port",
        type=click.IntRange(0, _LAST_PORT),
        default=PORT,
        metavar="N",
        help=f"The port to listen on (else {PORT}); 0 for any free port.",
    ),
    option(
        "--host",
        metavar="ADDRESS",
        help="Open the window to others, at this address of this computer (0.0.0.0: all).",
    ),
    flag("--read-only", help="Disable commands: steering, publishing and services."),
    flag("--open/--no-open", "opens", default=None, help="Open the browser, or not."),
    json_option,
    names_options,
    bus_options,
    bag_option,
    _collected,
)
"""The options of every panel; the command gets them as ``WindowChoice``."""


def open_window(choice: WindowChoice, panel: str = "", **settings: "Json") -> None:
    """Serve the window until Ctrl-C: one panel with its settings, or all.

    Raises:
        MissingExtra: The package websockets is not installed.
        LcmtoolsError: The port is in use, or the address is not this computer's.
    """
    with needing_extra("web", "gui needs"):
        from lcmtools.gui.server import Server
    from lcmtools.gui.access import access_for
    from lcmtools.gui.browser import has_display

    access = access_for(choice.host, [socket.gethostname()], is_read_only=choice.read_only)
    view: dict[str, Json] = {"panel": panel, "settings": settings} if panel else {}

    def say(port: int) -> None:
        addresses = access.addresses(_reached_at(choice.host), port)
        _write_addresses(addresses, as_json=choice.as_json)
        if has_display(os.environ) if choice.opens is None else choice.opens:
            webbrowser.open([*addresses.values()][-1])

    with _opened_source() as source:
        server = Server(source, access, view, notify)
        server.run_until_interrupted(choice.host or "127.0.0.1", choice.port, say)


@contextmanager
def _opened_source() -> "Iterator[Source]":
    """Open the log or the bus that the command line selects."""
    with ExitStack() as stack:
        source: Source
        if (log := chosen_log()) is not None:
            from lcmtools.gui.log_source import LogSource

            source = LogSource(log, notify)
        else:
            from lcmtools.gui.source import BusSource

            source = BusSource(stack.enter_context(open_monitor("gui")))
        stack.callback(source.close)
        yield source


def _write_addresses(addresses: Mapping[str, str], *, as_json: bool) -> None:
    if as_json:
        write_document(addresses)
        return
    for right, address in addresses.items():
        write_note(f"to {right}: {address}")
    write_note("Ctrl-C ends it")


def _reached_at(host: str | None) -> str:
    """Return the address at which others reach a server: this computer's address for 0.0.0.0."""
    return socket.gethostname() if host in ("0.0.0.0", "::") else host or "127.0.0.1"  # noqa: S104
