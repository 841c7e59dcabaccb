"""``lcmtools relay``."""

import signal
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from ipaddress import ip_address
from typing import NoReturn

import click

from lcmtools.bus.preflight import wait_for_bus
from lcmtools.bus.url import BusUrl, domain_url, parse_url
from lcmtools.cli.bus import chosen_url, open_monitor, with_notes
from lcmtools.cli.declare import argument, examples, flag, option, rate, subcommand
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.output import write_result
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError
from lcmtools.graph.relay_report import Link, State
from lcmtools.names import has_wildcard, resolve
from lcmtools.observe.reports.describe import size_text
from lcmtools.relay.ends import check_end
from lcmtools.relay.hub import Hub, HubCounts, serve
from lcmtools.relay.relay import Relay, attend
from lcmtools.relay.rules import Rules, check_rules
from lcmtools.relay.status import known_relays
from lcmtools.text_table import plural, text_table

_HEADING = ("relay", "host", "state", "bus", "sent to it", "left out", "trouble")

_TWO = 2


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
        url = with_notes(parse_url(serve, "--serve"), "--serve")
        check_server(url, buses)
        with StatusLine("lcmtools relay") as line:
            run_server(url, line)
    rules = Rules(allow, deny, read_rates(rates), newest, prefix_there.strip("/"), one_way)
    check_rules(rules)
    run_relay(chosen_buses(buses), rules, name)


def chosen_buses(words: Sequence[str]) -> tuple[BusUrl, BusUrl]:
    """Return the two buses of the command line. A single one joins the default bus.

    Raises:
        UsageError: There are none or more than two, both are the same, or one cannot be joined.
    """
    if not words or len(words) > _TWO:
        raise UsageError("a relay joins two buses", "for example lcmtools relay 0 1")
    read = (domain_url(one, "BUS") if one.isdigit() else parse_url(one, "BUS") for one in words)
    found = [with_notes(url, "BUS") for url in read]
    here, there = found if len(found) == _TWO else (chosen_url(), found[0])
    for url in (here, there):
        check_end(url)
    if (here.provider, here.host, here.port) == (there.provider, there.host, there.port):
        raise UsageError(f"both buses are {here}", "a relay joins two buses")
    return here, there


def read_rates(words: Sequence[str]) -> dict[str, float]:
    """Return the rates of ``--rate``, by pattern."""
    found = {}
    for word in words:
        topic, equals, text = word.rpartition("=")
        if not equals or not topic:
            what = f"'{word}' is not TOPIC=HZ; write '/camera/**=5'"
            raise click.BadParameter(what, param_hint="'--rate'")
        try:
            found[topic] = rate(text)
        except click.BadParameter as error:
            raise click.BadParameter(error.message, param_hint="'--rate'") from None
    return found


def run_relay(urls: tuple[BusUrl, BusUrl], rules: Rules, name: str) -> None:
    """Relay until Ctrl-C. Show rates on a terminal, and write totals at the end."""
    name = resolve(name) if name else ""

    def show_rates(link: Link) -> None:
        here, there = link.ends
        if rates := line.rates(here.messages, here.bytes, there.messages, there.bytes):
            back, on = (f"{rates[n]:.0f}/s, {size_text(rates[n + 1])}/s" for n in (0, 2))
            is_idle = link.state is State.STANDBY
            line.write("stands by" if is_idle else f"there {on}; back {back}; {_lost_text(link)}")

    with StatusLine("lcmtools relay") as line:
        if rules.allow and not any(map(has_wildcard, rules.allow)):
            only = f"only {' and '.join(rules.allow)} can pass"
            line.write_note(f"{only}; --allow '**' passes the other topics, too")
        for url in urls:
            wait_for_bus(url, line.write_note)
        relay = Relay(
            urls,
            rules,
            line.write_note,
            name=name,
            on_shutdown=lambda: signal.raise_signal(signal.SIGTERM),
        )
        try:
            with relay:
                attend(relay, show_rates)
        finally:
            line.write_note(_summary(relay.link))


def _summary(link: Link) -> str:
    here, there = link.ends
    carried = [
        f"{plural(end.messages, 'message')} ({size_text(end.bytes)}) to {end.bus}"
        for end in (there, here)
    ]
    return f"{', '.join(carried)}; {_lost_text(link)}"


def _lost_text(link: Link) -> str:
    """Return the counts of messages lost on the way to the relay, dropped there, and left out."""
    lost, dropped = (sum(getattr(end, what) for end in link.ends) for what in ("lost", "dropped"))
    parts = [f"{lost} lost on the way to the relay"] if lost else []
    parts += [f"{dropped} dropped"] if dropped else []
    left_out = sum(end.left_out for end in link.ends)
    text = ", ".join(parts) or "none lost"
    return f"{text}, {left_out} left out by its rules" if left_out else text


def run_server(url: BusUrl, line: StatusLine) -> NoReturn:
    """Serve tcpq until Ctrl-C. Show rates on a terminal, and write totals at the end."""
    with Hub(url, line.write_note) as hub:
        line.write_note(f"serves tcpq://{url.host}:{hub.port} to {_audience(url.host)}")
        own = f"tcpq://{_reachable(url.host)}:{hub.port}"
        line.write_note(f"is a bus of its own; to join another bus to it: lcmtools relay {own}")
        try:
            serve(hub, partial(_show, line), lambda: signal.raise_signal(signal.SIGTERM))
        finally:
            line.write_note(_counted(hub.counts))


def _show(line: StatusLine, counts: HubCounts) -> None:
    if rates := line.rates(counts.messages, counts.bytes):
        clients = plural(counts.clients, "client")
        flow = f"{rates[0]:.0f} messages/s, {size_text(rates[1])}/s"
        line.write(f"{clients}; {flow}; {_dropped(counts)}")


def _counted(counts: HubCounts) -> str:
    return f"{plural(counts.messages, 'message')} ({size_text(counts.bytes)}); {_dropped(counts)}"


def _dropped(counts: HubCounts) -> str:
    return f"{counts.dropped} dropped for slow clients" if counts.dropped else "none dropped"


def _reachable(host: str) -> str:
    """Return the address by which programs of this computer reach a server that listens on host."""
    return "127.0.0.1" if host == "0.0.0.0" else host  # noqa: S104 - compared only


def _audience(host: str) -> str:
    """Return a description of the programs that can connect to an address."""
    try:
        address = ip_address(host)
    except ValueError:
        return f"everyone who can reach {host}"
    if address.is_loopback:
        return "programs on this computer"
    what = "all its addresses" if address.is_unspecified else host
    return f"everyone who can reach this computer at {what}, without a password"


def check_server(url: BusUrl, buses: Sequence[str]) -> None:
    """Raise UsageError if a URL cannot be served, or buses are given besides it."""
    if buses:
        hint = f"start another relay that joins {url} and {buses[0]}"
        raise UsageError("--serve runs a server and does not join a bus", hint)
    if url.provider != "tcpq":
        raise UsageError(f"cannot serve {url}", "write --serve tcpq://:7700")


def show_status(*, as_json: bool) -> None:
    """Print the relays on the bus."""
    with open_monitor("relay") as monitor:
        links = known_relays(monitor)
        none = f"there is no relay on {monitor.url}"
    records = [{**asdict(link), "state": link.state.name.lower()} for link in links]
    write_result(records, text_table(_rows(links) if links else []), as_json=as_json, none=none)


def _rows(links: Sequence[Link]) -> list[Sequence[str]]:
    rows: list[Sequence[str]] = [_HEADING]
    for link in links:
        state = "carries" if link.state is State.ACTIVE else "stands by"
        names = (link.name, link.host, f"{state}, {_lost_text(link)}")
        for end in link.ends:
            sent = f"{end.messages} ({size_text(end.bytes)})"
            rows.append((*names, end.bus, sent, str(end.left_out), end.trouble))
            names = ("", "", "")
    return rows
