"""The relays on a bus, as a person asks for them."""

from collections.abc import Sequence
from dataclasses import asdict

from lcmtools.cli.bus import open_monitor
from lcmtools.cli.output import columns, show
from lcmtools.cli.relay.attending import lost_text
from lcmtools.graph.relay_report import Link, State
from lcmtools.observe.reports.describe import size_text
from lcmtools.relay.status import known_relays

_HEADING = ("relay", "host", "state", "bus", "sent to it", "left out", "trouble")


def show_status(*, as_json: bool) -> None:
    """Print the relays that are known on the bus."""
    with open_monitor("relay") as monitor:
        links = known_relays(monitor)
        none = f"there is no relay on {monitor.url}"
    records = [{**asdict(link), "state": link.state.name.lower()} for link in links]
    show(records, columns(_rows(links)) if links else [], as_json=as_json, none=none)


def _rows(links: Sequence[Link]) -> list[Sequence[str]]:
    rows: list[Sequence[str]] = [_HEADING]
    for link in links:
        state = "carries" if link.state is State.ACTIVE else "stands by"
        names = (link.name, link.host, f"{state}, {lost_text(link)}")
        for end in link.ends:
            sent = f"{end.messages} ({size_text(end.bytes)})"
            rows.append((*names, end.bus, sent, str(end.left_out), end.trouble))
            names = ("", "", "")
    return rows
