"""The options of ``lcmtools gui``, and opening the window."""

import os
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lcmtools.cli.bus import chosen_logs, notify, open_monitor
from lcmtools.cli.declare import CommandT, flag, option, together
from lcmtools.cli.options import bag_option, bus_options, json_option, names_options
from lcmtools.cli.output import write_document, write_note
from lcmtools.errors import needing_extra

if TYPE_CHECKING:  # not needed for the help
    from lcmtools.gui.protocol import Json
    from lcmtools.gui.source import Source
    from lcmtools.gui.steering import SpeedLimits

PORT = 7680
_PORTS = range(PORT, PORT + 10)
_LAST_PORT = 65535


@dataclass(frozen=True, slots=True)
class WindowChoice:
    """The options of the window."""

    port: int | None  # None for the first of the usual ones that is free
    host: str | None
    read_only: bool
    token: bool  # for this computer; others always need one
    opens: bool | None  # the browser; None where there is a display
    record_directory: Path | None  # None for the working directory
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
        metavar="N",
        help=f"The port to listen on (else {PORT} or the next free one); 0 for any free port.",
    ),
    option(
        "--host",
        metavar="ADDRESS",
        help="Open the window to others, at this address of this computer (0.0.0.0: all).",
    ),
    flag(
        "--read-only",
        help="Disable commands: steering, publishing, services, parameters, recording.",
    ),
    flag(
        "--token/--no-token",
        "token",
        default=True,
        help="Open the window only to who has its address, or to every user of this computer.",
    ),
    option(
        "--record-directory",
        metavar="DIR",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        help="Let pages record here (else in the working directory).",
    ),
    flag("--open/--no-open", "opens", default=None, help="Open the browser, or not."),
    json_option,
    names_options,
    bus_options,
    bag_option,
    _collected,
)
"""The options of every panel; the command gets them as ``WindowChoice``."""


def open_window(
    choice: WindowChoice, panel: str = "", limits: "SpeedLimits | None" = None, **settings: "Json"
) -> None:
    """Serve the window until Ctrl-C: one panel with its settings, or all.

    Pages can command velocities up to ``limits``; None for the usual ones.

    Raises:
        MissingExtra: The package websockets is not installed.
        PortInUse: The chosen port is in use.
        LcmtoolsError: The address is not this computer's.
    """
    with needing_extra("web", "gui needs"):
        from lcmtools.gui.server import PortInUse, Server
    from lcmtools.gui.access import access_for
    from lcmtools.gui.browser import own_token, show_page

    access = access_for(
        choice.host,
        [socket.gethostname()],
        is_read_only=choice.read_only,
        own_token=partial(own_token, environment=os.environ) if choice.token else None,
    )
    view: dict[str, Json] = {"panel": panel, "settings": settings} if panel else {}

    def say(port: int) -> None:
        addresses = access.addresses(_reached_at(choice.host), port)
        _write_addresses(addresses, as_json=choice.as_json)
        hint = show_page([*addresses.values()][-1], os.environ, opens=choice.opens)
        for line in () if choice.as_json else filter(None, (hint, "Ctrl-C ends it")):
            write_note(line)

    with _opened_source(limits, choice.record_directory or Path()) as source:
        server = Server(source, access, view, notify)
        host = choice.host or "127.0.0.1"
        for port in _PORTS if choice.port is None else ():
            with suppress(PortInUse):
                server.run_until_interrupted(host, port, say)
                return
        server.run_until_interrupted(host, choice.port or 0, say)


@contextmanager
def _opened_source(limits: "SpeedLimits | None", directory: Path) -> "Iterator[Source]":
    """Open the log or the bus that the command line selects."""
    with ExitStack() as stack:
        source: Source
        if logs := chosen_logs():
            from lcmtools.gui.log_source import LogSource

            source = LogSource(*logs, notify=notify)
        else:
            from lcmtools.gui.source import BusSource
            from lcmtools.gui.steering import SpeedLimits

            monitor = stack.enter_context(open_monitor("gui"))
            source = BusSource(monitor, limits or SpeedLimits(), directory)
        stack.callback(source.close)
        stack.callback(_finish_recording, source)
        yield source


def _finish_recording(source: "Source") -> None:
    if source.recordings and (told := source.recordings.stop()):
        notify(f"recorded {told}")


def _write_addresses(addresses: Mapping[str, str], *, as_json: bool) -> None:
    if as_json:
        write_document(addresses)
        return
    for right, address in addresses.items():
        write_note(f"open {address} to {right}" if len(addresses) > 1 else f"open {address}")


def _reached_at(host: str | None) -> str:
    """Return the address at which others reach a server: this computer's address for 0.0.0.0."""
    return socket.gethostname() if host in ("0.0.0.0", "::") else host or "127.0.0.1"  # noqa: S104
