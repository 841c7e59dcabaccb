"""Parts of the ``sim`` commands: their options, the call, and what is printed."""

from typing import TYPE_CHECKING, TypeVar

from lcmtools.cli.declare import CommandT, duration, option
from lcmtools.cli.options import bus_options, json_option, open_monitor
from lcmtools.cli.output import data, document
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message
from lcmtools.publish.simulator import call_simulator

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)

_sim_option = option(
    "--sim",
    "name",
    metavar="NODE",
    help="The simulator's node, if there are several.",
    completer="bus:nodes",
)
_timeout_option = option(
    "--timeout", type=duration, default=5.0, help="Longest wait for an answer (else 5s)."
)


def sim_options(command: CommandT) -> CommandT:
    """Add ``--sim``, ``--timeout`` and the options of the bus."""
    return _sim_option(_timeout_option(bus_options(command)))


def json_sim_options(command: CommandT) -> CommandT:
    """Add the same and ``--json``."""
    return _sim_option(_timeout_option(json_option(bus_options(command))))


def call(
    verb: str,
    service_type: "ServiceType[RequestT, ResponseT]",
    name: str | None,
    timeout: float,
    **fields: object,
) -> ResponseT:
    """Call a service of the simulator with these fields; see ``call_simulator``."""
    request = service_type.Request()
    for field, value in fields.items():
        setattr(request, field, value)
    with open_monitor(f"sim_{verb}") as monitor:
        return call_simulator(monitor, name, verb, service_type, request, timeout=timeout)


def show(response: Message, *, as_json: bool) -> None:
    """Print what the simulator has done."""
    if as_json:
        document(to_plain(response))
    else:
        data(response.message)  # type: ignore[attr-defined] # all responses of sim_msgs have it
