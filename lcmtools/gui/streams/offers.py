"""The stream of names that panels offer: topics, services, and nodes with parameters."""

from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.observe.reading.find import offered_services
from lcmtools.publish.remote_parameters import nodes_with_parameters


class Offers(PageStream):
    """The names of topics, of services with their types, and of nodes with parameters."""

    period = 0.5
    is_shared = True

    def update(self) -> Update:
        """Return the lists."""
        latest = self.source.latest
        graph = latest.graph
        services = [
            {"name": one.name, "types": one.types, "nodes": [node.name for node, _ in one.servers]}
            for one in offered_services(graph, show_all=False)
            if one.is_alive
        ]
        topics = [row.channel for row in latest.rows]
        nodes = [one.name for one in nodes_with_parameters(graph) if not one.stale]
        return Update({"topics": topics, "services": services, "nodes": nodes})
