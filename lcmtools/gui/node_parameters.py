"""Requests of pages for the parameters of nodes."""

from typing import cast

from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, publishers_of
from lcmtools.node.parameters import service_name
from lcmtools.observe.reading.find import find_node
from lcmtools.publish.parameter_report import to_json
from lcmtools.publish.remote_parameters import exchange_parameters, require_parameters
from lcmtools.types import lcmtools_msgs as msgs

_TIMEOUT = 3.0  # [s]


def read(source: Source, *, node: str) -> Json:
    """Return the parameters of ``node``, with values as YAML; see ``exchange_parameters``."""
    return _exchange(source, node, {})


def change(source: Source, *, node: str, name: str, value: str) -> Json:
    """Set a parameter by ``name`` to ``value`` (YAML); return all of the node's parameters."""
    return _exchange(source, node, {name: value})


def _exchange(source: Source, text: str, texts: dict[str, str]) -> Json:
    node = require_parameters(find_node(source.latest.graph, text)).name
    client = publishers_of(source).client(msgs.Parameters, service_name(node))
    found = exchange_parameters(client, node, _TIMEOUT, texts)
    return cast("Json", [{**to_json(node, one), "value": one.value} for one in found.values()])
