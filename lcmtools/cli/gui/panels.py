"""``lcmtools gui`` and its panels."""

import os
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lcmtools.cli.bus import chosen_logs, looking_names, notify, open_monitor
from lcmtools.cli.declare import (
    CommandT,
    argument,
    duration,
    examples,
    flag,
    option,
    subcommand,
    together,
)
from lcmtools.cli.options import bag_option, bus_options, json_option, names_options
from lcmtools.cli.output import write_document, write_note
from lcmtools.errors import needing_extra
from lcmtools.names import has_wildcard

if TYPE_CHECKING:
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
    from lcmtools.gui.browser import show_page
    from lcmtools.gui.own_token import own_token

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


_FASTEST = 10.0  # [m/s] and [rad/s], as in ``gui.steering``, which need not be loaded for the help
_limit = click.FloatRange(0.01, _FASTEST)


@subcommand("all", window_options)
@examples("gui", "gui all --port 8000", "gui all --host 192.168.1.20 --read-only")
def all_panels(window: WindowChoice) -> None:
    """Open a window with all panels in the browser, until Ctrl-C.

    Only this computer can open the page, and only you: the printed address contains a token. With
    --host it is open to others, by two addresses, one for watching and one for commanding.
    """
    open_window(window)


@subcommand("topics", window_options)
@examples("gui topics", "gui topics --read-only")
def topics(window: WindowChoice) -> None:
    """Show the topics in the browser: rate, bandwidth, loss, senders, messages; and publish."""
    open_window(window, "topics")


@subcommand("log", window_options)
@examples("gui log", "gui log --port 8000")
def log(window: WindowChoice) -> None:
    """Show the nodes' log lines in the browser: by level, node and text."""
    open_window(window, "log")


@subcommand("services", window_options)
@examples("gui services", "gui services /husky0/reset")
@argument("service", metavar="[SERVICE]", default="", completer="bus:services")
def services(window: WindowChoice, service: str) -> None:
    """Call services in the browser: a form for the request, and the answer."""
    open_window(window, "services", service=looking_names().resolve(service) if service else "")


@subcommand("parameters", window_options)
@examples("gui parameters", "gui parameters /husky0/simple_controller")
@argument("node", metavar="[NODE]", default="", completer="bus:nodes")
def parameters(window: WindowChoice, node: str) -> None:
    """Show the parameters of nodes in the browser, and set them."""
    open_window(window, "parameters", node=looking_names().resolve(node) if node else "")


@subcommand("record", window_options)
@examples("gui record", "gui record /husky0/odometry '/husky0/cmd_*'")
@argument("topics", metavar="[TOPIC]...", nargs=-1, completer="bus:topics")
def record(window: WindowChoice, topics: tuple[str, ...]) -> None:
    """Start and stop a recording in the browser, of topics that are ticked there.

    TOPICs, which may be patterns in quotes, are ticked at first. The log is written as by bag
    record, and complete when the window ends.
    """
    names = looking_names()
    spelled = ([one] if has_wildcard(one) else names.spellings(one) for one in topics)
    open_window(window, "record", topics=[name for some in spelled for name in some])


@subcommand("steer", window_options)
@examples("gui steer /husky0/desired_velocity", "gui steer /cmd_vel --max-linear 0.3")
@argument("topic", metavar="TOPIC", completer="bus:topics")
@option(
    "--max-linear",
    "linear",
    type=_limit,
    help="Maximum speed [m/s]; else 1, and pages may raise it to 10.",
)
@option(
    "--max-angular",
    "angular",
    type=_limit,
    help="Maximum turn rate [rad/s]; else 2, and pages may raise it to 10.",
)
def steer(window: WindowChoice, topic: str, linear: float | None, angular: float | None) -> None:
    """Steer a robot in the browser: joystick, sliders, keys, gamepad.

    The robot drives while a control is held, and stops when it is released, when the page is hidden
    or closed, and when the connection is lost. Messages are Twist, TwistStamped or similar.
    """
    name = looking_names().resolve(topic)
    from lcmtools.gui.steering import SpeedLimits

    limits = SpeedLimits(linear or _FASTEST, angular or _FASTEST)
    speeds = {"linear": linear or 1.0, "angular": angular or 2.0}
    open_window(window, "steer", limits, topic=name, **speeds)


@subcommand("plot", window_options)
@examples(
    "gui plot /husky0/odometry/twist.twist.linear.x /husky0/desired_velocity/linear.x",
    "gui plot /joint_states/position --window 30s",
)
@argument("fields", metavar="TOPIC/FIELD...", nargs=-1, completer="messages:topics_and_fields")
@option("--window", "length", type=duration, help="The time shown (else 10s, or a whole log).")
def plot(window: WindowChoice, fields: tuple[str, ...], length: float | None) -> None:
    """Plot fields of messages over time in the browser.

    An array gives a curve for each element, a message one for each of its numbers. With --bag the
    whole log is shown, with a line at the current time.
    """
    open_window(window, "plot", fields=list(fields), window=length)


@subcommand("image", window_options)
@examples("gui image /camera/depth/image_raw", "gui image /camera/rgb/image_raw/compressed")
@argument("topic", metavar="TOPIC", completer="bus:topics")
def image(window: WindowChoice, topic: str) -> None:
    """Show the images of a topic in the browser: colour, grey, and depth with its values."""
    open_window(window, "image", topic=topic)


@subcommand("graph", window_options)
@examples("gui graph", "gui graph --read-only")
def graph(window: WindowChoice) -> None:
    """Show the graph in the browser: nodes, topics, rates, and what wtf finds.

    Findings are marked at the nodes and topics concerned, and updated every few seconds.
    """
    open_window(window, "graph")


@subcommand("world", window_options)
@examples("gui world", "gui world --read-only")
def world(window: WindowChoice) -> None:
    """Show the world in 3D in the browser: robots, laser, points, paths, maps, trails.

    If the simulator runs, walls and objects are shown too; robots and crates can be dragged, and
    time can be paused. A click sends a pose.
    """
    open_window(window, "world")
