"""Whether there is a display for pybullet's window.

Without one, pybullet does not raise but ends the whole process: it must be asked before.
"""

import ctypes
from collections.abc import Mapping

from lcmtools.errors import LcmtoolsError


def check_display(environment: Mapping[str, str]) -> None:
    """Return if a window can be opened.

    Raises:
        LcmtoolsError: There is no display, or it does not let us in.
    """
    name = environment.get("DISPLAY", "")
    if not name:
        raise LcmtoolsError(
            "--gui needs a display and DISPLAY is not set",
            "leave out --gui, or run it in a desktop session or below xvfb-run",
        )
    if not _opens(name):
        raise LcmtoolsError(f"--gui cannot open the display '{name}'", "leave out --gui")


def _opens(name: str) -> bool:
    """Ask Xlib, which is also what pybullet loads and asks."""
    try:
        xlib = ctypes.CDLL("libX11.so.6")
    except OSError:
        return False
    xlib.XOpenDisplay.restype = ctypes.c_void_p
    xlib.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = xlib.XOpenDisplay(name.encode())
    if not display:
        return False
    xlib.XCloseDisplay(display)
    return True
