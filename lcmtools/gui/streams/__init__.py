"""The streams that a page can open. A kind is imported when it is first opened."""

from importlib import import_module

from lcmtools.gui.protocol import MalformedRequest
from lcmtools.gui.streams.base import PageStream

STREAMS = {
    "answer": "message:ServiceAnswer",
    "drawable": "world:Drawable",
    "findings": "findings:DoctorFindings",
    "frame-tree": "frame_tree:FrameTree",
    "frames": "world:Frames",
    "graph": "graph:GraphStream",
    "image": "image:NewestImage",
    "log": "log_lines:LogLines",
    "markers": "world:Markers",
    "message": "message:LatestMessage",
    "newest": "world:Newest",
    "offers": "offers:Offers",
    "plot": "plot:Plot",
    "publishing": "message_form:RepeatedForm",
    "recording": "recording:RecordingState",
    "steer": "steer:Steer",
    "topics": "topics:Topics",
}
"""The module and the class of each kind of stream."""


def stream_class(name: str) -> type[PageStream]:
    """Return a kind of stream; MalformedRequest if there is none with this name."""
    if name not in STREAMS:
        raise MalformedRequest(f"there is no stream '{name[:40]}'")
    module, attribute = STREAMS[name].split(":")
    found: type[PageStream] = getattr(import_module(f"lcmtools.gui.streams.{module}"), attribute)
    return found
