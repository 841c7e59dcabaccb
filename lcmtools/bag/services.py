"""The node whose services let other programs start, stop and save a recording."""

import contextlib
from collections.abc import Callable, Iterator

from lcmtools.arguments import NodeArguments
from lcmtools.bag.recorder import BagRecorder
from lcmtools.bus.url import BusUrl
from lcmtools.names import base_name_of, namespace_of
from lcmtools.node.node import Node
from lcmtools.node.process import open_context
from lcmtools.types.std_srvs import Trigger


@contextlib.contextmanager
def recorder_node(name: str, url: BusUrl, recorder: BagRecorder) -> Iterator[Node]:
    """Give a node, by its full name, with a recorder's services; the caller spins it.

    The services are std_srvs/Trigger: ``~/start`` and ``~/stop`` end and begin a pause, and
    ``~/save`` writes a snapshot.

    Raises:
        InvalidName: The name breaks the naming rules.
        BusError: The bus cannot be reached; the error says what to type.
    """
    context = open_context(url, NodeArguments(namespace=namespace_of(name)))
    try:
        with Node(base_name_of(name), context=context) as node:
            node.create_service(Trigger, "~/start", _answer(lambda: _pause(recorder, paused=False)))
            node.create_service(Trigger, "~/stop", _answer(lambda: _pause(recorder, paused=True)))
            if recorder.is_of_snapshots:
                node.create_service(Trigger, "~/save", _answer(recorder.save))
            yield node
    finally:
        context.close()


def _pause(recorder: BagRecorder, *, paused: bool) -> None:
    recorder.is_paused = paused


def _answer(
    act: Callable[[], None],
) -> Callable[[Trigger.Request, Trigger.Response], Trigger.Response]:
    def answer(_request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        act()
        response.success = True
        return response

    return answer
