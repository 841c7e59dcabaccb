"""The simulator on the bus: finding it, and asking it to do something."""

import math
import re
from collections.abc import Sequence
from typing import TypeVar

import click

from lcmtools.cli.asker import asking_node
from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import duration, open_monitor
from lcmtools.cli.output import data, document
from lcmtools.cli.service.offered import Offered, offered
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Staleness
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message
from lcmtools.node.service import ServiceType as Pair
from lcmtools.observe.find import find_node
from lcmtools.types.geometry_msgs import Pose

_MARK = "sim_msgs/Step"
"""The type of service that only simulators offer."""
_CLOCK = "/clock"
_NUMBER = re.compile(r"(?P<number>.+?)\s*(?P<unit>deg)?")

RequestT = TypeVar("RequestT", bound=Message)
ResponseT = TypeVar("ResponseT", bound=Message)

sim_option = click.option(
    "--sim",
    "name",
    metavar="NODE",
    help="The simulator's node, where several run.",
    shell_complete=complete("bus:nodes"),
)
timeout_option = click.option(
    "--timeout", type=duration, default=5.0, help="Wait so long for an answer (else 5s)."
)


def ask(
    name: str | None,
    verb: str,
    pair: "Pair[RequestT, ResponseT]",
    request: RequestT,
    timeout: float,
) -> ResponseT:
    """Ask the simulator to do something.

    Args:
        name: Its node's name; None where only one can be meant.
        verb: The service's name behind the node's.
        pair: The service's type.
        request: What is asked.
        timeout: Longest wait [s].

    Raises:
        LcmtoolsError: There is no simulator, or it could not do it, with the reason.
        ServiceTimeout: It did not answer.
    """
    with open_monitor(f"sim_{verb}") as watch:
        graph = watch.settle(foreign=False)
        if _may_be_late(graph):
            graph = watch.settle(foreign=False)
        simulator = _find(graph, name)
    with asking_node(f"sim_{verb}") as node:
        response = node.create_client(pair, f"{simulator}/{verb}").call(request, timeout)
    if not response.success:  # type: ignore[attr-defined] # all responses of sim_msgs have it
        raise LcmtoolsError(f"{simulator}: {response.message}")  # type: ignore[attr-defined]
    return response


def tell(response: Message, *, as_json: bool) -> None:
    """Print what the simulator has done."""
    if as_json:
        document(to_plain(response))
    else:
        data(response.message)  # type: ignore[attr-defined] # all responses of sim_msgs have it


def read_pose(words: Sequence[str]) -> Pose:
    """A pose on the ground from X, Y [m] and YAW ([rad], or "90deg"); what is left out is 0.

    Raises:
        UsageError: There are too many, or X without Y, or one is no number.
    """
    if len(words) > 3:  # noqa: PLR2004 - x, y, yaw
        raise UsageError(f"too many values: {' '.join(words)}", "write X Y YAW")
    if len(words) == 1:
        raise UsageError(f"'{words[0]}' alone is no place", "write X Y YAW, for example 1 -2 90deg")
    x, y, yaw = (*map(_number, words), *[0.0] * (3 - len(words)))
    pose = Pose()
    pose.position.x, pose.position.y = x, y
    pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return pose


def _number(word: str) -> float:
    form = _NUMBER.fullmatch(word)
    try:
        value = float(form["number"]) if form else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(f"'{word}' is not a number", "write X Y YAW, for example 1 -2 90deg")
    return math.radians(value) if form and form["unit"] else value


def _may_be_late(graph: Graph) -> bool:
    """Whether a busy simulator may not have answered yet; another one would be taken for it."""
    hangs = any(node.stale is Staleness.HANGS for node in graph.nodes)
    return hangs or not any(map(_is_mark, offered(graph)))


def _find(graph: Graph, name: str | None) -> str:
    """The full name of the simulator's node."""
    simulators = sorted({_node_of(service) for service in offered(graph) if _is_mark(service)})
    leaders = {node.name for node, _ in graph.topic(_CLOCK).publishers if not node.stale}
    if name is not None:
        node = find_node(graph, name)
        if node.name not in simulators:
            raise LcmtoolsError(f"{node.name} is no simulator", _these(simulators))
        return node.name
    if len(simulators) > 1 and len(leaders) == 1:  # the others follow its clock
        return leaders.pop()
    if len(simulators) > 1:
        raise LcmtoolsError("several simulators run", f"say which: --sim {simulators[0]}")
    if not simulators:
        raise LcmtoolsError("no simulator runs on this bus", "lcmtools run sim starts one")
    return simulators[0]


def _is_mark(service: Offered) -> bool:
    return service.is_alive and _MARK in service.types


def _node_of(service: Offered) -> str:
    return service.servers[0][0].name


def _these(simulators: Sequence[str]) -> str:
    return f"simulators: {', '.join(simulators)}" if simulators else "lcmtools run sim starts one"
