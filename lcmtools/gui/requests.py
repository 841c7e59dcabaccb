"""Requests with a single answer: questions and actions of a page.

A request is a function and a line in ``ASKS`` or, if it needs the right to command, in ``ACTIONS``.
It runs on its own thread, so that it may block.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TypeAlias

from lcmtools.gui.protocol import Json, MalformedRequest

Answer: TypeAlias = Callable[..., Json]
"""Returns the answer to a source and the request's values as keyword arguments.

An LcmtoolsError is shown to the user.
"""

ASKS = {
    "color maps": "streams.image:color_maps",
    "node-parameters": "node_parameters:read",
    "numbers": "choices:numbers",
    "timeline": "playback:timeline",
    "topics": "choices:topics",
    "type": "type_forms:describe",
    "types": "type_forms:names",
}
"""The module and the function of each question."""
ACTIONS = {
    "call": "service_calls:call",
    "play": "playback:play",
    "publish": "streams.message_form:publish",
    "record": "streams.recording:record",
    "send-pose": "simulators:send_pose",
    "set-parameter": "node_parameters:change",
    "simulate": "simulators:simulate",
    "stop-recording": "streams.recording:stop",
}
"""The same for each action, which only a page with the right to command may request."""


def answer(name: str, table: Mapping[str, str]) -> Answer:
    """Return the function of a request; MalformedRequest if there is none with this name."""
    if name not in table:
        raise MalformedRequest(f"there is no request '{name[:40]}'")
    module, attribute = table[name].split(":")
    found: Answer = getattr(import_module(f"lcmtools.gui.{module}"), attribute)
    return found
