"""``lcmtools service call``."""

import math

from lcmtools.cli.bus import in_names, looking_names, notify, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.negative_numbers import WITHOUT_END, CommandWithWait
from lcmtools.cli.options import (
    asking_options,
    json_option,
    rate_option,
    timeout_option,
    times_option,
)
from lcmtools.cli.output import write_data, write_note
from lcmtools.messages.plain import to_json
from lcmtools.messages.text import format_message
from lcmtools.observe.reading.find import OfferedService, find_service, full_service_name
from lcmtools.observe.reports.describe import node_text
from lcmtools.publish.calls import call_all, requests_in_time, split_type, wait_for_service
from lcmtools.publish.incoming import read_requests


def _wait(value: str | float) -> float:
    return math.inf if value == WITHOUT_END else duration(value)


@subcommand("call", timeout_option(3.0), json_option, asking_options, cls=CommandWithWait)
@examples(
    "service call /reset",
    'service call /switch "data: true"',
    "service call --wait=10s /add '{a: 1, b: -2}' --timeout 500ms",
    "service call -r 2 /switch true",
)
@argument("service", completer="bus:services")
@argument("words", metavar="[TYPE] [VALUES]...", nargs=-1, completer="messages:requests")
@option("--wait", type=_wait, metavar="[=DURATION]", help="Wait for a node that offers it.")
@option(
    "-f",
    "--file",
    metavar="FILE",
    help="Read requests from a YAML file ('-': standard input).",
    completer="files",
)
@rate_option("Call")
@times_option("Call")
@flag("-v", "--verbose", help="Print the called node.")
def command(
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
    """Call a service and print its response; VALUES are YAML, as for rosservice.

    A single dict sets fields by name; otherwise VALUES are the fields in order. Omitted fields keep
    their defaults. Several requests, separated by ---, can be piped in. TYPE is optional, as the
    node announces it. With -r or -t requests are repeated, each after the previous response, until
    one is not answered.

    \b
    Exit codes: 0 success, 1 the service failed or its response has success: False, 2 wrong usage,
    4 no response within --timeout. With --json each response is one line.
    """
    service = full_service_name(in_names(service), looking_names().namespace)
    with open_monitor("service_call") as monitor:
        monitor.settle(foreign=False)
        if wait is not None:
            end_with_reader()
            wait_for_service(monitor, service, wait, notify)
        found = find_service(monitor.graph(), service)
    pair, values = split_type(found, words)
    requests = read_requests(pair.Request, values, file, write_note)
    _tell_server(found, verbose=verbose)
    code = 0
    is_one = len(requests) == 1 and rate is None and times is None
    due = requests_in_time(requests, rate, times)
    for response in call_all(found, pair, due, timeout, monitor.url):
        text = to_json(response) if as_json else format_message(response)
        write_data(text if as_json or is_one else f"{text}\n---")
        if getattr(response, "success", True) is False:  # as Trigger and SetBool report a failure
            code = 1
    return code


def _tell_server(service: OfferedService, *, verbose: bool) -> None:
    names = [node_text(node) for node, _ in service.servers]
    if len(names) > 1:
        notify(
            f"{len(names)} nodes offer {service.name}: {', '.join(names)}; each"
            " executes the request, and the first response is used"
        )
    elif verbose:
        notify(f"asking {names[0]} ({service.type_text})")
