"""``lcmtools relay``."""

from lcmtools.bus.url import parse_url
from lcmtools.cli.declare import examples, option, subcommand
from lcmtools.cli.relay.serving import attend_hub, check_server
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError


@subcommand("relay")
@examples(
    "relay --serve tcpq://:7700",
    "relay --serve tcpq://0.0.0.0:7700",
)
@option("--serve", metavar="URL", help="Be a tcpq server: tcpq://:7700 on this computer only.")
def command(*, serve: str | None) -> None:
    """Serve LCM's provider tcpq, for programs that multicast does not reach, until Ctrl-C.

    LCM's own programs of every language connect to it: LCM_DEFAULT_URL=tcpq://HOST:7700. It needs
    no Java. Without a host it listens on the loopback only; tcpq has no passwords. A client that
    reads too slowly gets the newest messages, and delays nobody else.
    """
    if serve is None:
        raise UsageError("missing option '--serve'", "write --serve tcpq://:7700")
    url = parse_url(serve, "--serve")
    check_server(url)
    with StatusLine("lcmtools relay") as line:
        attend_hub(url, line)
