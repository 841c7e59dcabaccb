"""The simulator on a bus: any node with the services of lcm_types/sim_msgs."""

from typing import TYPE_CHECKING, TypeVar

from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Staleness
from lcmtools.messages.registry import Message
from lcmtools.observe.reading.find import OfferedService, find_node, offered_services
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.publish.own_node import own_node

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

_MARK = "sim_msgs/Step"
"""The type of service that only simulators offer."""
_CLOCK = "/clock"
_HOW_TO_START = "lcmtools run sim starts one"

RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)


def call_simulator(
    monitor: BusMonitor,
    name: str | None,
    verb: str,
    service_type: "ServiceType[RequestT, ResponseT]",
    *,
    timeout: float,
    **fields: object,
) -> ResponseT:
    """Call ``<node>/<verb>`` of the simulator ``name``, or of the only one, with this request.

    Raises:
        LcmtoolsError: There is no simulator, or it refused; the error has its reason.
        ServiceTimeout: It did not answer.
    """
    request = service_type.Request()
    for field, value in fields.items():
        setattr(request, field, value)
    graph = monitor.settle(foreign=False)
    if _may_be_late(graph):
        graph = monitor.settle(foreign=False)
    simulator = find_simulator(graph, name)
    with own_node(f"sim_{verb}", monitor.url) as node:
        response = node.create_client(service_type, f"{simulator}/{verb}").call(request, timeout)
    if not response.success:  # type: ignore[attr-defined] # all responses of sim_msgs have it
        raise LcmtoolsError(f"{simulator}: {response.message}")  # type: ignore[attr-defined]
    return response


def find_simulator(graph: Graph, name: str | None) -> str:
    """Return the full name of the simulator's node; for None, the only one, or the one with /clock.

    Raises:
        LcmtoolsError: There is none of this name, none at all, or there are several.
    """
    marks = (service for service in offered_services(graph) if _is_mark(service))
    simulators = sorted({service.servers[0][0].name for service in marks})
    leaders = {node.name for node, _ in graph.topic(_CLOCK).publishers if not node.stale}
    if name is not None:
        node = find_node(graph, name)
        if node.name not in simulators:
            known = f"simulators: {', '.join(simulators)}" if simulators else _HOW_TO_START
            raise LcmtoolsError(f"{node.name} is not a simulator", known)
        return node.name
    if len(simulators) > 1 and len(leaders) == 1:  # the others follow the clock of this one
        return leaders.pop()
    if len(simulators) > 1:
        raise LcmtoolsError("several simulators run", f"choose one: --sim {', '.join(simulators)}")
    if not simulators:
        raise LcmtoolsError("no simulator runs on this bus", _HOW_TO_START)
    return simulators[0]


def _may_be_late(graph: Graph) -> bool:
    """True if a busy simulator may not have answered yet: another must not be taken for it."""
    hangs = any(node.stale is Staleness.HANGS for node in graph.nodes)
    return hangs or not any(map(_is_mark, offered_services(graph)))


def _is_mark(service: OfferedService) -> bool:
    return service.is_alive and _MARK in service.types
