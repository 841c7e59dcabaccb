"""The parameters of another node, asked for and changed over the bus by its hidden service."""

from collections.abc import Mapping
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout, ValueMismatch
from lcmtools.messages.setting import Setting, read_setting
from lcmtools.node.node import Node
from lcmtools.node.parameters import service_name
from lcmtools.types import lcmtools_msgs as msgs


@dataclass(frozen=True, slots=True)
class RemoteParameter:
    """A parameter as its node tells it.

    Attributes:
        name: Its name, without the node's.
        kind: Its type: see lcmtools.messages.setting.kind_of.
        text: Its value as YAML in one line.
        description: What it is for; "" when the node does not say.
        minimum: Its smallest value as YAML; "" for none.
        maximum: Its largest value as YAML; "" for none.
        read_only: It cannot change while the node runs.
    """

    name: str
    kind: str
    text: str
    description: str = ""
    minimum: str = ""
    maximum: str = ""
    read_only: bool = False

    def value(self) -> Setting:
        """The value; the text of one that this version cannot read."""
        try:
            return read_setting(self.text, self.kind, self.name)
        except (ValueMismatch, KeyError):
            return self.text


class RefusedParameters(LcmtoolsError):  # noqa: N818 - named for what happened, as in errors.py
    """A node has not changed its parameters, and says why.

    Attributes:
        reasons: One for each parameter that is wrong.
    """

    def __init__(self, node: str, reasons: tuple[str, ...]) -> None:
        text = "; ".join(reasons)
        super().__init__(text if text.startswith(f"{node} ") else f"{node} refuses: {text}")
        self.reasons = reasons


class RemoteParameters:
    """The parameters of another node.

    Args:
        own: The node that asks.
        target: The full name of the node that is asked.
    """

    def __init__(self, own: Node, target: str) -> None:
        self._target = target
        self._client = own.create_client(msgs.Parameters, service_name(target))

    def get(self, timeout: float) -> dict[str, RemoteParameter]:
        """All parameters by name, sorted.

        Args:
            timeout: Seconds to wait for the answer.

        Raises:
            ServiceTimeout: The node does not answer in time.
        """
        return self._ask({}, timeout)

    def set(self, texts: Mapping[str, str], timeout: float) -> dict[str, RemoteParameter]:
        """Change parameters, all or none; return all of the node's.

        Args:
            texts: The new values as YAML, by name.
            timeout: Seconds to wait for the answer.

        Raises:
            RefusedParameters: The node has changed nothing.
            ServiceTimeout: The node does not answer in time.
        """
        return self._ask(texts, timeout)

    def _ask(self, texts: Mapping[str, str], timeout: float) -> dict[str, RemoteParameter]:
        request = msgs.Parameters_Request()
        request.changes = [_change(*item) for item in texts.items()]
        response = self._call(request, timeout)
        if response.errors:
            raise RefusedParameters(self._target, tuple(response.errors))
        return {parameter.name: _remote(parameter) for parameter in response.parameters}

    def _call(self, request: msgs.Parameters_Request, timeout: float) -> msgs.Parameters_Response:
        try:
            return self._client.call(request, timeout)
        except ServiceTimeout:
            raise ServiceTimeout(
                f"{self._target} did not answer within {timeout:g} s",
                "it is busy or does not spin; lcmtools wtf looks closer",
            ) from None
        except ServiceError as error:
            what = error.what.replace(service_name(self._target), self._target, 1)
            raise ServiceError(what) from None


def _change(name: str, text: str) -> msgs.Parameter:
    change = msgs.Parameter()
    change.name, change.value = name, text
    return change


def _remote(message: msgs.Parameter) -> RemoteParameter:
    return RemoteParameter(
        message.name,
        message.type,
        message.value,
        message.description,
        message.minimum,
        message.maximum,
        bool(message.read_only),
    )
