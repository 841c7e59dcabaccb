"""The choice of a display, the rate of pictures, and the loop of a viewing node."""

import argparse
import os
import sys
import time
from collections.abc import Sequence

import lcmtools
from lcmtools import Node
from lcmtools.errors import DecodeError, MissingExtra, NothingReceived, UsageError
from lcmtools.gui.browser import has_display
from lcmtools.gui.protocol import Json
from lcmtools.labs.nodes.argument_parser import NodeParser, at_least, one_of, read_command_line
from lcmtools.labs.nodes.ending import ended_by_signals
from lcmtools.labs.nodes.picture.colors import ColorOptions
from lcmtools.labs.nodes.picture.display import Display, LineDisplay
from lcmtools.labs.nodes.picture.screen import ScreenDisplay
from lcmtools.messages.pictures import read_picture
from lcmtools.messages.pixels import COLOR_MAPS
from lcmtools.messages.registry import Message
from lcmtools.terminal import is_terminal
from lcmtools.types.sensor_msgs import CompressedImage, Image

_TURN = 0.03  # longest time between two calls of the display's ``attend`` [s]
_RATE, _LINES_RATE = 10.0, 1.0
_ANSWERED = 0.3  # time that nodes have to say what they publish [s]
_PICTURES = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}
_ELSEWHERE = "in a browser: --window"
_MOST = 3  # topics that a hint names


def viewer_parser() -> argparse.ArgumentParser:
    """Return a parser of the options of a node that shows pictures."""
    positive = at_least(1e-3, "a number above 0")
    parser = NodeParser()
    parser.add_argument("--save", metavar="FILE")
    parser.add_argument("--values", action="store_true")
    parser.add_argument("--once", action="store_true")
    parser.add_argument("--rate", type=positive)
    parser.add_argument("--timeout", type=positive)
    parser.add_argument("--colors", type=one_of(tuple(COLOR_MAPS)), default="warm")
    parser.add_argument("--near", type=at_least(0.0, "a depth in metres"))
    parser.add_argument("--far", type=positive)
    parser.add_argument("--window", action="store_true")
    parser.add_argument("--terminal", action="store_true")
    parser.add_argument("--json", action="store_true")
    return parser


def open_viewer(args: Sequence[str] | None, help_text: str | None) -> "Viewer | None":
    """Return a viewer for a node's command line; None if ``--help`` was given and printed.

    Raises:
        UsageError: Arguments are wrong or exclude each other.
        MissingExtra: A package for the display is not installed.
    """
    help_text = f"{(help_text or '').strip()}\n\n{_OPTIONS_HELP}"
    options = read_command_line(args, help_text, viewer_parser())
    return Viewer(options) if options else None


class Viewer:
    """Shows the newest picture; ``viewer_parser`` parses its options.

    Raises:
        UsageError: Options contradict each other.
        MissingExtra: A package for the display is not installed.
    """

    def __init__(self, options: argparse.Namespace) -> None:
        self._display = choose_display(options)
        is_fast = options.save or not isinstance(self._display, LineDisplay)
        self._period = 1 / (options.rate or (_RATE if is_fast else _LINES_RATE))
        self._is_single: bool = options.once
        self._timeout: float | None = options.timeout
        self._newest: Image | CompressedImage | None = None
        self._next_time = self._last_time = 0.0
        self._is_waiting = True  # for the first one
        self.is_over = False

    def take(self, message: Message) -> None:
        """Show an Image or CompressedImage when it is due, unless a newer one replaces it."""
        assert isinstance(message, Image | CompressedImage)
        if self._display.needs_pictures:
            self._newest = message
        self._is_waiting = False
        self._last_time = time.monotonic()

    def run(self, node: Node, topic: str) -> None:
        """Show pictures until the display is closed or the program ends; a single one with --once.

        Raises:
            NothingReceived: None came within the time given.
            DecodeError: The picture of --once cannot be shown.
        """
        self._last_time = time.monotonic()
        if self._is_single:
            node.context.note = ""  # the picture is all that is wanted
        node.warn_of_unused_arguments()
        with ended_by_signals(node):
            try:
                self._display.open(node, topic)
                node.graph()  # the first call asks the nodes, for _tell_if_unpublished
                while lcmtools.ok() and not (self.is_over or self._display.is_over):
                    lcmtools.spin_once(node, _TURN)
                    self._display.attend()
                    self._show_if_due()
                    self._check_time(topic)
                    self._tell_if_unpublished(node, topic)
            finally:
                self._display.close()

    def _show_if_due(self) -> None:
        now = time.monotonic()
        if self._newest is None or now < self._next_time:
            return
        message, self._newest = self._newest, None
        self._next_time = max(self._next_time + self._period, now)
        try:
            picture = read_picture(message)
        except DecodeError as error:
            if self._is_single:
                raise
            self._display.show_text(str(error))
            return
        self._display.show(picture)
        self.is_over = self._is_single

    def _tell_if_unpublished(self, node: Node, topic: str) -> None:
        """Report once that no node publishes the topic, with the topics that have pictures."""
        if not self._is_waiting or time.monotonic() - self._last_time < _ANSWERED:
            return
        self._is_waiting = False
        topics = [one for one in node.graph().topics() if one.publishers]
        if topic in [one.name for one in topics]:
            return
        others = [one.name for one in topics if not _PICTURES.isdisjoint(one.types)]
        hint = (
            f"pictures are on {', '.join(others[:_MOST])}" if others else "lcmtools list shows all"
        )
        self._display.show_text(f"no node publishes {topic}; {hint}")

    def _check_time(self, topic: str) -> None:
        waited = time.monotonic() - self._last_time
        if self._timeout is not None and waited > self._timeout and not self.is_over:
            raise NothingReceived(
                f"no picture came on {topic} within {self._timeout:g} s",
                f"lcmtools info {topic} shows its publishers",
            )


def choose_display(options: argparse.Namespace) -> Display:
    """Return the display that options, terminal and environment ask for.

    Raises:
        UsageError: Options contradict each other.
        MissingExtra: A package for the display is not installed.
    """
    colors = ColorOptions(COLOR_MAPS[options.colors], options.near, options.far)
    if options.values and not options.save:
        raise UsageError("--values needs --save", "add --save FILE")
    for other in ("once", "save", "json", "terminal"):
        if options.window and getattr(options, other):
            raise UsageError(f"--window and --{other} exclude each other", "leave out one of them")
    if options.window:
        return _browser(options)
    is_screen = is_terminal(sys.stdout) and os.environ.get("TERM", "dumb") != "dumb"
    if options.save or options.json or not is_screen:
        return LineDisplay(
            colors, options.save or "", as_values=options.values, as_json=options.json
        )
    if has_display(os.environ) and not (options.once or options.terminal):
        try:
            return _browser(options)
        except MissingExtra as error:
            print(f"{error}; shown in the terminal", file=sys.stderr)  # noqa: T201 - a node's own output
    is_remote = not (has_display(os.environ) or options.once)
    return ScreenDisplay(colors, is_single=options.once, note=_ELSEWHERE if is_remote else "")


def _browser(options: argparse.Namespace) -> Display:
    settings = panel_settings(options)
    from lcmtools.labs.nodes.picture.browser import BrowserDisplay

    return BrowserDisplay(settings)


def panel_settings(options: argparse.Namespace) -> dict[str, Json]:
    """Return the settings of the browser's panel, whose scale has both ends or none.

    Raises:
        UsageError: The far end is missing.
    """
    near, far = options.near, options.far
    if near is not None and far is None:
        raise UsageError("--near needs --far in the browser", "add --far M or --terminal")
    settings: dict[str, Json] = {"map": options.colors}
    if far is not None:
        settings |= {"near": near or 0.0, "far": far}
    return {**settings, "rate": options.rate} if options.rate else settings


_OPTIONS_HELP = """\
Options:
    --window          in the browser, also where there is no display: the address is printed
    --terminal        in the terminal
    --once            end after one picture, drawn in the terminal
    --save FILE       write PNG files, and show nothing; %d or %04d in the name counts
    --values          ... with depth as 16-bit millimetres, not in colour
    --rate HZ         at most this many pictures a second (10, in the browser more; 1 for lines)
    --timeout S       fail with exit code 4 if no picture comes for this long
    --near M --far M  the scale's ends (else by the picture)
    --colors MAP      warm or grey
    --json            a line of JSON for each picture

Pictures are shown in the browser where there is a display, else in the terminal. If standard output
is not a terminal, a line of text is written for each picture."""
