"""Pictures in a window, by tkinter, which comes with most Pythons."""

import importlib
import os
from types import ModuleType
from typing import Protocol, cast

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.labs.nodes.picture.colors import ColorOptions, colored, facts, sentence
from lcmtools.labs.nodes.picture.pixels import Picture

_USUAL_SIZE = (640, 480)


class _Window(Protocol):
    """The part of tkinter.Tk that is used."""

    def title(self, text: str) -> None: ...
    def geometry(self, size: str) -> None: ...
    def configure(self, *, background: str) -> None: ...
    def protocol(self, name: str, function: object) -> None: ...
    def bind(self, key: str, function: object) -> None: ...
    def update(self) -> None: ...
    def destroy(self) -> None: ...
    def winfo_width(self) -> int: ...
    def winfo_height(self) -> int: ...


class _Label(Protocol):
    """The part of tkinter.Label that is used."""

    def configure(self, **options: object) -> None: ...
    def pack(self, **options: object) -> None: ...


class WindowDisplay:
    """Shows pictures in a window, as large as that is; closing it, q and Escape end.

    Args:
        options: The colours.
    """

    def __init__(self, options: ColorOptions) -> None:
        self.is_over = False
        self._options = options
        self._tkinter = _import_tkinter()
        self._window: _Window | None = None
        self._label: _Label | None = None
        self._image: object = None  # tkinter keeps no reference itself

    def open(self, title: str) -> None:
        """Open the window.

        Raises:
            LcmtoolsError: There is no display.
        """
        if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise LcmtoolsError(
                "there is no display for a window", "leave --window out, or use --save FILE"
            )
        try:
            self._window = cast(_Window, self._tkinter.Tk())
        except self._tkinter.TclError as error:
            raise LcmtoolsError(
                f"there is no window: {error}", "leave --window out, or use --save FILE"
            ) from None
        self._label = cast(_Label, self._tkinter.Label(self._window, background="black"))
        self._label.configure(foreground="white", compound="top", text="waiting for a picture")
        self._label.pack(expand=True, fill="both")
        self._window.title(title)
        self._window.geometry("x".join(map(str, _USUAL_SIZE)))
        self._window.protocol("WM_DELETE_WINDOW", self._end)
        for key in ("q", "<Escape>"):
            self._window.bind(key, self._end)
        self._window.update()

    def show(self, picture: Picture) -> None:
        """Show a picture as large as the window."""
        if self._window and self._label:
            room = self._window.winfo_width(), max(1, self._window.winfo_height() - 24)
            from PIL import ImageTk

            self._image = ImageTk.PhotoImage(colored(picture.fitted(*room), self._options).image)
            self._label.configure(image=self._image, text=sentence(facts(picture)))

    def say(self, text: str) -> None:
        """Write a reason in place of the picture."""
        if self._label:
            self._label.configure(image="", text=text)

    def attend(self) -> None:
        """Handle the window's events."""
        if self._window and not self.is_over:
            try:
                self._window.update()
            except self._tkinter.TclError:  # its display is gone
                self.is_over = True

    def close(self) -> None:
        """Close the window."""
        window, self._window, self._label = self._window, None, None
        if window:
            try:
                window.destroy()
            except self._tkinter.TclError:
                return  # gone already

    def _end(self, *_: object) -> None:
        self.is_over = True


def _import_tkinter() -> ModuleType:
    try:
        return importlib.import_module("tkinter")
    except ImportError as error:
        raise MissingExtra(
            "a window needs Python's tkinter, which is not installed",
            "install it (Debian: apt install python3-tk), or leave --window out",
        ) from error
