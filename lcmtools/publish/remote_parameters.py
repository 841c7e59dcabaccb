"""The parameters of other nodes: finding, reading and changing them.

A parameter is named as in rosparam, ``/husky0/driver/gain``, or by two words as in ros2:
``/husky0/driver gain``.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout, UsageError, ValueMismatch
from lcmtools.graph.model import Graph, NodeInfo, Role
from lcmtools.messages.setting import ParameterValue, read_setting
from lcmtools.names import MAX_CHANNEL_BYTES, did_you_mean
from lcmtools.node.node import Node
from lcmtools.node.parameters import service_name
from lcmtools.node.service import Client, request_channel
from lcmtools.observe.reading.find import find_node
from lcmtools.publish.temporary_node import temporary_node
from lcmtools.types import lcmtools_msgs as msgs

_AT_ONCE = 16  # nodes whose parameters are read at the same time


class RefusedParameters(LcmtoolsError):  # noqa: N818 - named for the event, as in errors.py
    """A node has refused to change its parameters; ``reasons`` has one for each wrong parameter."""

    def __init__(self, node: str, reasons: tuple[str, ...]) -> None:
        text = "; ".join(reasons)
        names_node = text.startswith(f"{node} ")
        super().__init__(text if names_node else f"{node} rejects the change: {text}")
        self.reasons = reasons


Parameters: TypeAlias = Mapping[str, msgs.Parameter]
"""A node's parameters by name, as it reports them."""
Answers: TypeAlias = Mapping[str, Parameters]
"""The parameters of each node that answered, by its name."""


@dataclass(frozen=True, slots=True)
class ParameterClient:
    """Reads and changes the parameters of nodes, waiting ``timeout`` seconds for each answer."""

    url: BusUrl
    timeout: float

    def get_all(self, nodes: Sequence[NodeInfo]) -> tuple[Answers, list[ServiceError]]:
        """Return the parameters of nodes, and the errors of those that did not answer."""
        if not nodes:
            return {}, []
        with temporary_node("param", self.url) as own, ThreadPoolExecutor(_AT_ONCE) as pool:
            names = (node.name for node in nodes)
            asked = {n: pool.submit(request_parameters, own, n, self.timeout) for n in names}
            try:
                wait(asked.values())
            except BaseException:
                own.context.stop()  # else Ctrl-C would wait for nodes that do not answer
                raise
        answers: dict[str, Parameters] = {}
        errors: list[ServiceError] = []
        for name, answer in asked.items():
            try:
                answers[name] = answer.result()
            except ServiceError as error:  # noqa: PERF203 - each node fails on its own
                errors.append(error)
        return answers, errors

    def request(self, node: str, texts: Mapping[str, str] | None = None) -> Parameters:
        """Change parameters of one node, or only read them; see ``request_parameters``."""
        with temporary_node("param", self.url) as own:
            return request_parameters(own, node, self.timeout, texts)


def request_parameters(
    own: Node, node: str, timeout: float, texts: Mapping[str, str] | None = None
) -> Parameters:
    """Set the parameters that ``texts`` has, all or none; return all of the node's, sorted.

    Args:
        own: The node that sends the request.
        node: The full name of the node with the parameters.
        timeout: Longest wait for the answer [s].
        texts: The new values as YAML, by name; None to read only.

    Raises:
        RefusedParameters: The node has changed nothing.
        ServiceTimeout: It has not answered in time.
        ServiceError: It has failed.
    """
    client = own.create_client(msgs.Parameters, service_name(node))
    return exchange_parameters(client, node, timeout, texts)


def exchange_parameters(
    client: Client[msgs.Parameters_Request, msgs.Parameters_Response],
    node: str,
    timeout: float,
    texts: Mapping[str, str] | None = None,
) -> Parameters:
    """Do the same with a client that the caller keeps."""
    request = msgs.Parameters_Request()
    for name, text in (texts or {}).items():
        change = msgs.Parameter()
        change.name, change.value = name, text
        request.changes.append(change)
    try:
        response = client.call(request, timeout)
    except ServiceTimeout:
        hint = "it is busy or does not spin; lcmtools wtf shows more"
        raise ServiceTimeout(f"{node} did not answer within {timeout:g} s", hint) from None
    except ServiceError as error:
        raise ServiceError(error.what.replace(client.name, node, 1)) from None
    if response.errors:
        raise RefusedParameters(node, tuple(response.errors))
    return {parameter.name: parameter for parameter in response.parameters}


def value_of(parameter: msgs.Parameter) -> ParameterValue:
    """Return a parameter's value; its text if this version cannot read its type."""
    try:
        return read_setting(parameter.value, parameter.type, parameter.name)
    except (ValueMismatch, KeyError):
        return parameter.value


def has_parameters(node: NodeInfo) -> bool:
    """Return whether a node announces a service for its parameters."""
    return service_name(node.name) in (end.topic for end in node.having(Role.SERVICE))


def nodes_with_parameters(graph: Graph) -> list[NodeInfo]:
    """Return the nodes that have parameters, sorted by name; of those of one name, a living one."""
    found: dict[str, NodeInfo] = {}
    for node in graph.nodes:
        known = found.get(node.name)
        if has_parameters(node) and (known is None or known.stale):
            found[node.name] = node
    return list(found.values())


def require_parameters(node: NodeInfo) -> NodeInfo:
    """Return a node that runs and has parameters; LcmtoolsError if it does not."""
    if node.stale:
        raise LcmtoolsError(f"{node.name} {node.stale}", "lcmtools node list shows the nodes")
    if not has_parameters(node):
        spare, length = MAX_CHANNEL_BYTES - len(request_channel(service_name(""))), len(node.name)
        reason = "it offers no service for that"
        if length > spare:
            reason = f"its name has {length} characters, and with more than {spare} it has none"
        raise LcmtoolsError(f"{node.name} has no parameters to query", reason)
    return node


def pick(parameters: Parameters, name: str, node: str, place: str = "") -> msgs.Parameter:
    """Return a parameter by its name; LcmtoolsError, with a hint, if the node does not have it."""
    if name not in parameters:
        hint = did_you_mean(name, parameters) or f"it has {', '.join(parameters)}"
        raise LcmtoolsError(f"{place}{node} has no parameter '{name}'", hint)
    return parameters[name]


@dataclass(frozen=True, slots=True)
class ParameterTarget:
    """One node and its parameter (None: all of them), or the nodes of a namespace."""

    nodes: tuple[NodeInfo, ...]
    parameter: str | None = None
    is_namespace: bool = False

    @property
    def node(self) -> NodeInfo:
        """The only node; UsageError for a namespace."""
        if self.is_namespace:
            names = ", ".join(node.name for node in self.nodes)
            raise UsageError("a node is needed here, not a namespace", f"write one of {names}")
        return self.nodes[0]


def find_target(graph: Graph, words: Sequence[str]) -> ParameterTarget:
    """Return the node, parameter or namespace with nodes that one or two words name.

    Raises:
        UsageError: A name is empty.
        LcmtoolsError: There is no such node, or it has no parameters.
    """
    if len(words) > 1:
        node = require_parameters(find_node(graph, words[0]))
        return ParameterTarget((node,), words[1].removeprefix(f"{node.name}/") or None)
    word = words[0]
    if not word:
        raise UsageError("the name is empty", "lcmtools param list shows the parameters")
    for name, rest in _splits(word.rstrip("/")):
        if any(not node.tool for node in graph.named(name)):
            return ParameterTarget((require_parameters(find_node(graph, name)),), rest or None)
    known = nodes_with_parameters(graph)
    prefix = f"/{word.strip('/')}/" if word.strip("/") else "/"
    inside = [node for node in known if not node.stale and node.name.startswith(prefix)]
    if inside:
        return ParameterTarget(tuple(inside), is_namespace=True)
    raise _unknown(word, [node.name for node in known])


def _splits(word: str) -> Iterator[tuple[str, str]]:
    """Split a name into a node's and a parameter's at each slash, the longest node name first."""
    end = len(word)
    while end > 0:
        yield word[:end], word[end + 1 :]
        end = word.rfind("/", 0, end)


def _unknown(word: str, nodes: Sequence[str]) -> LcmtoolsError:
    base = word.rstrip("/").rpartition("/")[0]
    for candidate in filter(None, (word, base)):
        full = candidate if candidate.startswith("/") else f"/{candidate}"
        if hint := did_you_mean(full, nodes):
            return LcmtoolsError(f"there is no node for {word}", hint)
    hint = "lcmtools param list shows the parameters" if nodes else "no node with parameters runs"
    return LcmtoolsError(f"there is no node for {word}", hint)
