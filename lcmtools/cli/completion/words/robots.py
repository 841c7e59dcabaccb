"""Robots that simulators simulate."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.graph.model import Node, Role

_STATE = "sim_msgs/GetState"
"""The service that only simulators offer."""


def robots(situation: Situation) -> Iterator[Candidate]:
    """The robots' namespaces; without the slash before them where the word has none."""
    found = {robot: node.name for node in situation.graph.nodes for robot in _robots_of(node)}
    is_global = not situation.word or situation.word.startswith("/")
    for robot, simulator in sorted(found.items()):
        yield Candidate(robot if is_global else robot.removeprefix("/"), simulator)


def _robots_of(node: Node) -> set[str]:
    """Whom the commands that it takes are for: the last word of their group is the namespace."""
    if not any(_STATE in service.types for service in node.having(Role.SERVICE)):
        return set()
    groups = {one.group for one in node.having(Role.SUBSCRIBER)}
    return {group.rpartition(" ")[2] for group in groups if group}
