"""``lcmtools foxglove``."""

from contextlib import ExitStack

from lcmtools.bag.choice import RecordedTopics
from lcmtools.cli.bus import looking_names, notify, open_monitor
from lcmtools.cli.declare import argument, examples, option, subcommand, whole_number
from lcmtools.cli.options import bus_options, exclude_option, json_option, names_options
from lcmtools.cli.output import write_document
from lcmtools.errors import UsageError

_ALL = "**"
_LAST_PORT = 65535


@subcommand("foxglove", names_options, bus_options)
@examples(
    "foxglove",
    "foxglove '/husky0/**' --exclude '**/image_raw'",
    "foxglove --allow-publish /husky0/desired_velocity",
    "foxglove --allow-origin https://app.foxglove.dev",
)
@argument("topics", metavar="[TOPIC]...", nargs=-1, completer="bus:topics")
@exclude_option
@option(
    "--allow-publish",
    "allowed",
    metavar="[TOPIC]",
    multiple=True,
    is_flag=False,
    flag_value=_ALL,
    help="Let clients publish on a topic, what a pattern matches, or without either on all.",
    completer="bus:topics",
)
@option(
    "--allow-origin",
    "origins",
    metavar="ORIGIN",
    multiple=True,
    help="Let pages of a website connect: https://app.foxglove.dev. Others are refused.",
)
@option(
    "--port",
    metavar="N",
    type=whole_number(0),
    default=8765,
    help="The port (else 8765; 0 for any).",
)
@option(
    "--host",
    metavar="ADDRESS",
    default="127.0.0.1",
    help="The address to listen at (else 127.0.0.1).",
)
@json_option
def command(
    topics: tuple[str, ...],
    *,
    exclude: tuple[str, ...],
    allowed: tuple[str, ...],
    origins: tuple[str, ...],
    port: int,
    host: str,
    as_json: bool,
) -> None:
    """Serve the bus to Foxglove and Lichtblick, until Ctrl-C.

    Every topic but hidden ones is offered with the type of ROS 1 that its messages have; in
    Foxglove, "Open connection" takes the address. TOPIC may be a pattern in quotes. Only what a
    panel asks for is decoded. With --allow-publish its panels may publish. Web pages need
    --allow-origin; a refused one is reported with what to type. --json prints the address for
    scripts, once all topics are offered.
    """
    from lcmtools.foxglove.bridge import Bridge
    from lcmtools.foxglove.origin_gate import OriginGate, parse_origin
    from lcmtools.foxglove.websocket import FoxgloveServer
    from lcmtools.publish.temporary_node import temporary_node

    if port > _LAST_PORT:
        raise UsageError(f"there is no port {port}", f"ports are 0 to {_LAST_PORT}")
    pages = [parse_origin(origin) for origin in origins]
    names = looking_names()
    choice = RecordedTopics(topics, names, exclude=exclude)
    with ExitStack() as stack:
        monitor = stack.enter_context(open_monitor("foxglove", plays=True))
        node = stack.enter_context(temporary_node("foxglove", monitor.url)) if allowed else None
        may_publish = RecordedTopics(allowed, names) if allowed else None
        bridge = stack.enter_context(Bridge(monitor, choice, notify, node, may_publish))
        encodings = bridge.publishing.encodings if bridge.publishing else ()
        server = stack.enter_context(FoxgloveServer(bridge, encodings))
        inner = server.host, server.port
        gate = stack.enter_context(OriginGate((host, port), inner, pages, bridge.refuse_origin))
        address = f"ws://{host}:{gate.port}"

        def say() -> None:
            if as_json:
                write_document({"address": address})
            else:
                notify(f"open a connection to {address} in Foxglove or Lichtblick")

        bridge.serve(server, say)
