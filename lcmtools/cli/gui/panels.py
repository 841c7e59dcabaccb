"""``lcmtools gui`` and its panels."""

from lcmtools.cli.declare import examples, subcommand
from lcmtools.cli.gui.window import WindowChoice, open_window, window_options


@subcommand("all", window_options)
@examples("gui", "gui all --port 8000", "gui all --host 192.168.1.20 --read-only")
def all_panels(window: WindowChoice) -> None:
    """Open a window with all panels in the browser, until Ctrl-C.

    The page is for this computer alone, unless --host opens it to others: then the addresses that
    are printed hold a token, one for watching and one for commanding.
    """
    open_window(window)


@subcommand("topics", window_options)
@examples("gui topics", "gui topics --read-only")
def topics(window: WindowChoice) -> None:
    """Show the topics in the browser: rate, bandwidth, loss, senders, messages; and publish."""
    open_window(window, "topics")
