"""``lcmtools service call``."""

import math
import time
from collections.abc import Iterable, Iterator

import click

from lcmtools.cli.asker import asking_node
from lcmtools.cli.completion.completer import complete, complete_files
from lcmtools.cli.describe import node_text
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_monitor,
    whole_number,
)
from lcmtools.cli.options import rate as rate_option
from lcmtools.cli.output import data, talk
from lcmtools.cli.service.offered import Offered, find_service, full_name, near_service, offered
from lcmtools.cli.service.offered import shown as shown_services
from lcmtools.cli.service.pace import in_time
from lcmtools.cli.words import WITHOUT_END, CommandWithWords
from lcmtools.errors import LcmtoolsError, NothingReceived, ServiceTimeout
from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import Message, ServiceType
from lcmtools.messages.text import format_message
from lcmtools.node.service import Client
from lcmtools.observe.monitor import BusMonitor
from lcmtools.publish.requests import read_requests, split_type

_PATIENCE = 2.0  # [s] before the person is told what is waited for


class _Call(CommandWithWords):
    may_stand_alone = ("--wait",)


def _wait(value: str | float) -> float:
    return math.inf if value == WITHOUT_END else duration(value)


@click.command("call", cls=_Call, context_settings=CONTEXT)
@click.argument("service", shell_complete=complete("bus:services"))
@click.argument(
    "words", metavar="[TYPE] [VALUES]...", nargs=-1, shell_complete=complete("messages:requests")
)
@click.option("--timeout", type=duration, default=3.0, help="Wait so long for an answer (else 3s).")
@click.option(
    "--wait", type=_wait, metavar="[=DURATION]", help="Wait until a node offers the service."
)
@click.option(
    "-f",
    "--file",
    metavar="FILE",
    help="Read requests from a YAML file ('-': standard input).",
    shell_complete=complete_files,
)
@click.option("-r", "--rate", type=rate_option, help="Call so many times a second until Ctrl-C.")
@click.option(
    "-t", "--times", metavar="N", type=whole_number(1), help="Call N times and end; 1 Hz or -r."
)
@click.option("-v", "--verbose", is_flag=True, help="Say which node is asked.")
@json_option
@bus_options
def command(  # noqa: PLR0913 - one parameter an option
    service: str,
    words: tuple[str, ...],
    *,
    timeout: float,
    wait: float | None,
    file: str | None,
    rate: float | None,
    times: int | None,
    verbose: bool,
    as_json: bool,
) -> int:
    """Call a service and print its response; VALUES are YAML, as rosservice takes them.

    One value that is a dict names fields; otherwise values are the fields in order. Fields that
    are left out keep their defaults. Several requests, separated by ---, can be piped in. TYPE may
    be written as ros2 wants it; the node has announced it. With -r or -t requests are repeated, the
    next one when the last is answered; the first that is not answered is the end.

    \b
    Exit codes: 0 answered, 1 the service failed, or its response has success: False, 2 wrong
    usage, 4 no answer within --timeout. With --json each response is one line.

    \b
    Examples:
      lcmtools service call /reset
      lcmtools service call /switch "data: true"
      lcmtools service call --wait=10s /add '{a: 1, b: -2}' --timeout 500ms
      lcmtools service call -r 2 /switch true
    """  # noqa: D301 - \b is click's mark
    full_name(service)  # an empty name is wrong whatever is on the bus
    with open_monitor("service_call") as monitor:
        monitor.settle(foreign=False)
        if wait is not None:
            _await(monitor, service, wait)
        found = find_service(monitor.graph(), service)
        pair, values = split_type(found, words)
        requests = read_requests(pair.Request, values, file)
        _tell_server(found, verbose=verbose)
        code = 0
        is_one = len(requests) == 1 and rate is None and times is None
        for response in _responses(found, pair, in_time(requests, rate, times), timeout):
            text = to_json(response) if as_json else format_message(response)
            data(text if as_json or is_one else f"{text}\n---")
            code = code or _outcome(response)
    return code


def _responses(
    service: Offered,
    pair: type[ServiceType],
    requests: Iterable[MessageTemplate[Message]],
    timeout: float,
) -> Iterator[Message]:
    """The answers, one by one.

    Raises:
        ServiceTimeout: An answer did not come in time; with what became of the server.
        ServiceError: The service reports a failure.
    """
    with asking_node("service_call") as node:
        client: Client[Message, Message] = node.create_client(pair, service.name)  # type: ignore[arg-type] # known by its name only
        try:
            for request in requests:
                yield client.call(request.at(time.time_ns()), timeout)
        except ServiceTimeout as error:
            raise ServiceTimeout(error.what, _fate(service)) from None


def _fate(service: Offered) -> str:
    """What has become of the node that did not answer; seen anew, by who answers now."""
    server = service.servers[0][0]
    with open_monitor("service_call") as monitor:
        now = [node for node in monitor.settle(foreign=False).nodes if node.id == server.id]
    if not now:
        return f"its node {server.name} has ended"
    if now[0].stale:
        return f"its node {server.name} {now[0].stale}"
    return f"its node {server.name} (pid {server.pid}) runs: is it busy? --timeout 10s waits longer"


def _tell_server(service: Offered, *, verbose: bool) -> None:
    names = [node_text(node) for node, _ in service.servers]
    command_name = click.get_current_context().command_path
    if len(names) > 1:
        talk(
            f"{command_name}: {len(names)} nodes offer {service.name}: {', '.join(names)}; each"
            " does what is asked, and the first answer counts"
        )
    elif verbose:
        talk(f"{command_name}: asking {names[0]} ({service.type_text})")


def _outcome(response: Message) -> int:
    """1 for what says itself that it did not succeed, as Trigger and SetBool do."""
    return 1 if getattr(response, "success", True) is False else 0


def _await(monitor: BusMonitor, service: str, longest: float) -> None:
    """Wait until a living node offers a service; say so where that takes long.

    Raises:
        NothingReceived: None does within ``longest`` seconds.
    """
    name, start, has_told = full_name(service), time.monotonic(), False
    while not any(s.name == name and s.is_alive for s in offered(monitor.graph())):
        waited = time.monotonic() - start
        if waited >= longest:
            raise NothingReceived(
                f"no node offers {name} within {longest:g} s", near_service(monitor.graph(), name)
            )
        if waited >= _PATIENCE and not has_told:
            has_told = True
            talk(f"{click.get_current_context().command_path}: {_situation(monitor, name)}")
        try:
            monitor.receive(min(0.2, longest - waited))
        except EOFError:
            raise LcmtoolsError(f"no node offers {name}: the log has ended") from None


def _situation(monitor: BusMonitor, name: str) -> str:
    """What is waited for, and what there is instead."""
    known = [service.name for service in shown_services(monitor.graph())]
    there = f"there is {', '.join(known[:8])}" if known else "no node offers any"
    return f"waiting for the service {name}; {there}"
