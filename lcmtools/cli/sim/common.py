"""Common parts of the ``sim`` commands: options, the service call, and its response."""

from typing import TYPE_CHECKING

from lcmtools.cli.bus import open_monitor
from lcmtools.cli.declare import option, together
from lcmtools.cli.options import bus_options, json_option, timeout_option
from lcmtools.cli.output import write_document, write_lines
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message
from lcmtools.publish.simulator import RequestT, ResponseT, call_simulator

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

_simulator = "The simulator's node, if there are several."
_sim_option = option("--sim", "name", metavar="NODE", help=_simulator, completer="bus:nodes")

sim_options = together(_sim_option, timeout_option(5.0), bus_options)
json_sim_options = together(_sim_option, timeout_option(5.0), json_option, bus_options)


def call(
    verb: str,
    service_type: "ServiceType[RequestT, ResponseT]",
    name: str | None,
    timeout: float,
    **fields: object,
) -> ResponseT:
    """Call a service of the simulator with these fields; see ``call_simulator``."""
    with open_monitor(f"sim_{verb}") as monitor:
        return call_simulator(monitor, name, verb, service_type, timeout=timeout, **fields)


def write_response(response: Message, *, as_json: bool) -> None:
    """Print the simulator's response."""
    if as_json:
        write_document(to_plain(response))
    else:
        write_lines([response.message])  # type: ignore[attr-defined] # responses of sim_msgs have it
