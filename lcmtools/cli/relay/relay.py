"""``lcmtools relay``."""

from lcmtools.bus.url import parse_url
from lcmtools.cli.declare import argument, examples, flag, option, subcommand
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.relay.attending import (
    attend_hub,
    attend_relay,
    check_server,
    chosen_buses,
    read_rates,
    show_status,
)
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError
from lcmtools.relay.rules import Rules, check_rules


@subcommand("relay", json_option, bus_options)
@examples(
    "relay 0 1",
    "relay tcpq://office:7700 --allow '/husky0/**' --allow /husky0/cmd_vel",
    "relay 0 1 --one-way --rate '/camera/**=5' --newest '/camera/**'",
    "relay 0 tcpq://office:7700 --prefix-there robot7",
    "relay --serve tcpq://:7700",
    "relay --status",
)
@argument("buses", metavar="[BUS [BUS]]", nargs=-1, completer="bus:urls")
@flag("--one-way", help="Carry messages from the first bus to the second one only.")
@option("--allow", multiple=True, metavar="TOPIC", help="Let only these pass; may be a pattern.")
@option("--deny", multiple=True, metavar="TOPIC", help="Leave these out; may be a pattern.")
@option(
    "--rate", "rates", multiple=True, metavar="TOPIC=HZ", help="Pass at most HZ messages a second."
)
@option(
    "--newest",
    multiple=True,
    metavar="TOPIC",
    help="Queue only the newest message for a slow line.",
)
@option(
    "--prefix-there", default="", metavar="NAME", help="Namespace of the topics on the second bus."
)
@option("--name", default="", metavar="NAME", help="The name of the relay's node.")
@option("--serve", metavar="URL", help="Run a tcpq server (tcpq://:7700: this computer only).")
@flag("--status", help="Show the relays on the bus, and exit.")
def command(
    buses: tuple[str, ...],
    *,
    one_way: bool,
    allow: tuple[str, ...],
    deny: tuple[str, ...],
    rates: tuple[str, ...],
    newest: tuple[str, ...],
    prefix_there: str,
    name: str,
    serve: str | None,
    status: bool,
    as_json: bool,
) -> None:
    """Carry messages between two buses, or serve LCM's provider tcpq, until Ctrl-C.

    BUS is a URL or a domain's number; with one BUS, the other is the default bus. Nodes of each bus
    are seen on the other, marked with their own bus; services, parameters and latched topics work.
    TOPIC is a name, or a pattern in quotes, as on the first bus. Commands to actuators, /clock and
    LCM's self tests pass only if --allow gives their exact name: --allow '**' --allow /cmd_vel
    passes all other topics and this command. If several relays join the same buses, the oldest one
    works, and the others stand by.

    --serve runs a server for LCM programs of all languages: LCM_DEFAULT_URL=tcpq://HOST:7700.
    Without a host it listens on the loopback only; tcpq has no passwords. A client that reads too
    slowly gets only the newest messages, and does not delay the others.
    """
    if status:
        show_status(as_json=as_json)
        return
    if as_json:
        raise UsageError("--json is for --status", "leave it out")
    if serve is not None:
        url = parse_url(serve, "--serve")
        check_server(url, buses)
        with StatusLine("lcmtools relay") as line:
            attend_hub(url, line)
    rules = Rules(allow, deny, read_rates(rates), newest, prefix_there.strip("/"), one_way)
    check_rules(rules)
    attend_relay(chosen_buses(buses), rules, name)
