"""The browser of this computer's user."""

import socket
import sys
import webbrowser
from collections.abc import Mapping
from threading import Thread
from urllib.parse import urlsplit

from lcmtools.gui.access import LOCAL


def has_display(environment: Mapping[str, str]) -> bool:
    """Return True if a browser can open a window for the user."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def show_page(address: str, environment: Mapping[str, str], *, opens: bool | None = None) -> str:
    """Open a page in the browser; if ``opens`` is None, where there is a display.

    It is opened from a thread of its own, because some browsers return only when they are closed,
    and read the page from this process before that.

    Return a line about opening it from another computer, or "" if it is not needed.
    """
    if opens is False:
        return ""
    if (opens or has_display(environment)) and _has_browser():
        Thread(target=webbrowser.open, args=[address], name="browser", daemon=True).start()
        return ""
    parts = urlsplit(address)
    if parts.hostname not in LOCAL:
        return ""
    forwarding = f"ssh -L {parts.port}:localhost:{parts.port} {socket.gethostname()}"
    return f"from another computer: type {forwarding} there, then open the same address"


def _has_browser() -> bool:
    try:
        webbrowser.get()
    except webbrowser.Error:
        return False
    return True
