"""The browser of this computer's user, and the tokens that keep its other users out.

Tokens are derived from a secret in a file that only the user can read, so that a page finds the
server again after a restart, and bookmarks stay valid.
"""

import hmac
import os
import re
import secrets
import socket
import stat
import sys
import webbrowser
from base64 import urlsafe_b64encode
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from threading import Thread
from urllib.parse import urlsplit

from lcmtools.folders import home_folder, write_atomically
from lcmtools.gui.access import LOCAL

_LENGTH = 22  # characters of a token: 128 bits
_SECRET = re.compile(r"[\w-]{43}\n?")


def own_token(right: str, environment: Mapping[str, str]) -> str:
    """Return the token of this user for a right; another one each time if no file can be kept."""
    digest = hmac.digest(_secret(environment).encode(), right.encode(), "sha256")
    return urlsafe_b64encode(digest).decode()[:_LENGTH]


def _secret(environment: Mapping[str, str]) -> str:
    new = secrets.token_urlsafe(32)
    base = home_folder(environment, "XDG_STATE_HOME", ".local/state")
    with suppress(OSError):
        if base is None:
            return new
        file = base / "lcmtools" / "window_secret"
        if file.exists() and _is_private(file):
            text = file.read_text(errors="replace")
            if _SECRET.fullmatch(text):
                return text.strip()
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(file, f"{new}\n", private=True)
    return new


def _is_private(file: Path) -> bool:
    """Return True for a regular file that only this user can read or change."""
    about = file.stat()
    is_own = about.st_uid == os.getuid() and stat.S_ISREG(about.st_mode)
    return is_own and not about.st_mode & 0o077


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
