"""The browser of this computer's user."""

import sys
from collections.abc import Mapping


def has_display(environment: Mapping[str, str]) -> bool:
    """Return True if a browser can open a window for the user."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))
