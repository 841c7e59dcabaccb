"""Pictures in the browser, in the image panel of ``lcmtools gui``."""

import contextlib
import os
from collections.abc import Mapping
from functools import partial

from lcmtools import Node
from lcmtools.errors import needing_extra
from lcmtools.gui.access import access_for
from lcmtools.gui.browser import own_token, show_page
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import BusSource
from lcmtools.labs.nodes.picture.display import Display
from lcmtools.messages.pictures import Picture
from lcmtools.observe.reading.monitor import BusMonitor

with needing_extra("web", "pictures in the browser need"):
    from lcmtools.gui.server import Server

_ADDRESS = "127.0.0.1"


class BrowserDisplay(Display):
    """Serves a page that reads the pictures itself, and opens it where there is a display.

    ``settings`` are those of the panel, but for the topic.
    """

    needs_pictures = False

    def __init__(self, settings: Mapping[str, Json]) -> None:
        self._settings = settings
        self._at_close = contextlib.ExitStack()

    def open(self, node: Node, topic: str) -> None:
        """Serve the page, write its address, and open it.

        Raises:
            LcmtoolsError: It cannot be served.
        """
        url = node.context.url
        assert url is not None, "the bus is not a private one"
        monitor = self._at_close.enter_context(BusMonitor(url, "gui", os.environ))
        source = BusSource(monitor)
        self._at_close.callback(source.close)
        token = partial(own_token, environment=os.environ)
        access = access_for(None, is_read_only=True, own_token=token)
        view: dict[str, Json] = {"panel": "image", "settings": {"topic": topic, **self._settings}}
        server = Server(source, access, view, self.show_text)
        port = self._at_close.enter_context(server.serving(_ADDRESS, 0))
        (address,) = access.addresses(_ADDRESS, port).values()
        self.show_text(f"open {address} to see {topic}; Ctrl-C ends it")
        if hint := show_page(address, os.environ):
            self.show_text(hint)

    def show(self, picture: Picture) -> None:
        """Leave the picture to the page."""

    def close(self) -> None:
        """Close the page's connection."""
        self._at_close.close()
