"""The simulator on a bus: any node with the services of lcm_types/sim_msgs."""

from typing import TYPE_CHECKING, TypeVar

from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Staleness
from lcmtools.messages.registry import Message
from lcmtools.observe.reading.find import find_node
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.simulators import publishes_time, simulators
from lcmtools.publish.temporary_node import temporary_node

if TYPE_CHECKING:
    from lcmtools.node.service import ServiceType

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
    with temporary_node(f"sim_{verb}", monitor.url) as node:
        response = node.create_client(service_type, f"{simulator}/{verb}").call(request, timeout)
    if not response.success:  # type: ignore[attr-defined] # all responses of sim_msgs have it
        raise LcmtoolsError(f"{simulator}: {response.message}")  # type: ignore[attr-defined]
    return response


def find_simulator(graph: Graph, name: str | None) -> str:
    """Return the full name of the simulator's node; for None, the only one, or the one with /clock.

    Raises:
        LcmtoolsError: There is none of this name, none at all, or there are several.
    """
    known = sorted({node.name for node in simulators(graph)})
    leaders = {node.name for node in simulators(graph) if publishes_time(node)}
    if name is not None:
        node = find_node(graph, name)
        if node.name not in known:
            hint = f"simulators: {', '.join(known)}" if known else _HOW_TO_START
            raise LcmtoolsError(f"{node.name} is not a simulator", hint)
        return node.name
    if len(known) > 1 and len(leaders) == 1:  # the others follow the clock of this one
        return leaders.pop()
    if len(known) > 1:
        raise LcmtoolsError("several simulators run", f"choose one: --sim {', '.join(known)}")
    if not known:
        raise LcmtoolsError("no simulator runs on this bus", _HOW_TO_START)
    return known[0]


def _may_be_late(graph: Graph) -> bool:
    """True if a busy simulator may not have answered yet: another must not be taken for it."""
    hangs = any(node.stale is Staleness.HANGS for node in graph.nodes)
    return hangs or not simulators(graph)
