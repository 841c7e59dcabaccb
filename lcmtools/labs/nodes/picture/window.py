"""Pictures in a window, by tkinter, which comes with most Pythons."""

import contextlib

from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.labs.nodes.picture.colors import ColorOptions, colored, facts, sentence
from lcmtools.labs.nodes.picture.display import Display
from lcmtools.labs.nodes.picture.pixels import Picture

try:
    import tkinter as tk

    from PIL import ImageTk
except ImportError as error:
    raise MissingExtra(
        "a window needs Python's tkinter, which is not installed",
        "install it (Debian: apt install python3-tk), or leave --window out",
    ) from error

_USUAL_SIZE = "640x480"


class WindowDisplay(Display):
    """Shows pictures in a window, as large as that is; closing it, q and Escape end.

    Raises:
        LcmtoolsError: There is no display.
    """

    def __init__(self, options: ColorOptions) -> None:
        self._options = options
        self._image: ImageTk.PhotoImage | None = None  # tkinter keeps no reference itself
        try:
            self._window = tk.Tk()
        except tk.TclError as error:
            raise LcmtoolsError(
                f"no window can be opened: {error}", "leave --window out, or use --save FILE"
            ) from None
        self._label = tk.Label(
            self._window,
            background="black",
            foreground="white",
            compound="top",
            text="waiting for a picture",
        )
        self._label.pack(expand=True, fill="both")
        self._window.geometry(_USUAL_SIZE)
        self._window.protocol("WM_DELETE_WINDOW", self._end)
        for key in ("q", "<Escape>"):
            self._window.bind(key, self._end)

    def open(self, title: str) -> None:
        """Show the window."""
        self._window.title(title)
        self.attend()

    def show(self, picture: Picture) -> None:
        """Show a picture as large as the window."""
        room = self._window.winfo_width(), max(1, self._window.winfo_height() - 24)
        self._image = ImageTk.PhotoImage(colored(picture.fitted(*room), self._options).image)
        self._label.configure(image=self._image, text=sentence(facts(picture)))

    def show_text(self, text: str) -> None:
        """Write a reason in place of the picture."""
        self._label.configure(image="", text=text)

    def attend(self) -> None:
        """Handle the window's events."""
        try:
            self._window.update()
        except tk.TclError:  # its display is gone
            self.is_over = True

    def close(self) -> None:
        """Close the window."""
        with contextlib.suppress(tk.TclError):  # gone already
            self._window.destroy()

    def _end(self, *_: object) -> None:
        self.is_over = True
