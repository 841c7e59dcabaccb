"""The tokens of a user's own windows, which keep the computer's other users out.

They are derived from a secret in a file that only the user can read, so that a page finds the
server again after a restart, and bookmarks stay valid.
"""

import hmac
import os
import re
import secrets
import stat
from base64 import urlsafe_b64encode
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from lcmtools.folders import home_folder, write_atomically

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
