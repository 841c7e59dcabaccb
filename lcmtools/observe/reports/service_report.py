"""A service as lines of text and as values for JSON."""

from collections.abc import Iterator

from lcmtools.observe.measuring.counters import callback_json, callback_times
from lcmtools.observe.reading.find import OfferedService
from lcmtools.observe.reports import node_list_report
from lcmtools.observe.reports.describe import listed_node


def to_lines(service: OfferedService, *, is_only: bool) -> Iterator[str]:
    """Yield the lines of a service with its nodes, with its name unless it is the only one."""
    yield from [] if is_only else [f"Service: {service.name}"]
    for node, endpoint in service.servers:
        took = callback_times(endpoint)
        yield from (f"Node: {listed_node(node)}", f"Host: {node.host}", f"Pid: {node.pid}")
        yield f"Calls: {endpoint.messages}{f', {took}' if took else ''}"
    names = service.arguments()
    yield f"Type: {service.type_text}"
    yield f"Args: {'unknown' if names is None else ' '.join(names)}"
    if service.clients:
        yield from ("Clients:", *(f" * {listed_node(node)}" for node in service.clients))


def to_json(service: OfferedService) -> dict[str, object]:
    """Return the same for JSON."""
    return {
        "service": service.name,
        "types": list(service.types),
        "args": service.arguments(),
        "servers": [
            {**node_list_report.to_json(n), "calls": e.messages, **callback_json(e)}
            for n, e in service.servers
        ],
        "clients": [node.name for node in service.clients],
    }
