"""Options that several commands share, each defined once."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import click
from click.core import ParameterSource

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.output import talk
from lcmtools.errors import UsageError
from lcmtools.settings import COLORS, parse_duration, read_user_file, usual_namespace

if TYPE_CHECKING:  # lcmtools --help and usage errors do without the bus
    from lcmtools.bus.url import BusUrl
    from lcmtools.observe.monitor import BusMonitor

CommandT = TypeVar("CommandT", bound=Callable[..., object])

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

COLOR = "lcmtools.color"
"""Where a click context's ``meta`` has what ``--color`` said."""


@dataclass(slots=True)
class BusChoice:
    """What was said about the bus, before and after the command's name."""

    url: str | None = None
    domain: str | None = None


def _remember(ctx: click.Context, parameter: click.Parameter, value: str | None) -> str | None:
    choice = ctx.ensure_object(BusChoice)
    if value is not None:
        setattr(choice, "url" if parameter.name == "lcm_url" else "domain", value)
    return value


def bus_options(command: CommandT) -> CommandT:
    """Add ``--lcm-url`` and ``--domain``; ``chosen_url`` reads them."""
    url = click.option(
        "--lcm-url",
        metavar="URL",
        callback=_remember,
        expose_value=False,
        shell_complete=complete("bus:urls"),
        help="The bus, for example 'udpm://239.255.76.67:7667?ttl=0' (else LCM_DEFAULT_URL).",
    )
    domain = click.option(
        "--domain",
        metavar="N",
        callback=_remember,
        expose_value=False,
        help="The bus on port 7667 + N (else LCMTOOLS_DOMAIN). A URL wins over it.",
    )
    return url(domain(command))


json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON.")
all_option = click.option(
    "-a", "--all", "show_all", is_flag=True, help="Show hidden names too (a part starts with '_')."
)


def _choose_color(ctx: click.Context, parameter: click.Parameter, value: str | None) -> None:
    said = ctx.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
    if value and said and not ctx.resilient_parsing:
        os.environ["LCMTOOLS_COLOR"] = value  # for nodes, and whatever this process starts
        ctx.meta[COLOR] = value


def _never_color(ctx: click.Context, parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    _choose_color(ctx, parameter, "never" if value else None)


def _debug(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value and not ctx.resilient_parsing:
        os.environ["LCMTOOLS_DEBUG"] = "1"


def manner_options(*, hidden: bool) -> list[click.Option]:
    """``--color``, ``--no-color`` and ``--debug``, which may stand anywhere.

    Args:
        hidden: Leave them out of help, as every command but the root does.
    """
    return [
        click.Option(
            ["--color"],
            type=click.Choice(COLORS),
            envvar="LCMTOOLS_COLOR",
            metavar="WHEN",
            callback=_choose_color,
            expose_value=False,
            hidden=hidden,
            help="Colour: auto, always or never (else LCMTOOLS_COLOR; NO_COLOR counts).",
        ),
        click.Option(
            ["--no-color"],
            is_flag=True,
            callback=_never_color,
            expose_value=False,
            hidden=True,
        ),
        click.Option(
            ["--debug"],
            is_flag=True,
            callback=_debug,
            expose_value=False,
            hidden=hidden,
            help="Show the traceback of an error.",
        ),
    ]


def duration(value: str | float) -> float:
    """A time span in seconds: ``2``, ``2s``, ``500ms`` or ``1m``; for ``type=``."""
    try:
        return parse_duration(str(value))
    except UsageError as error:
        raise click.BadParameter(str(error)) from None


def rate(value: str | float) -> float:
    """A positive number of times a second; for ``type=``."""
    try:
        number = float(value)
    except ValueError:
        raise click.BadParameter(f"'{value}' is not a number") from None
    if not 0 < number < float("inf"):
        raise click.BadParameter("the rate must be greater than zero")
    return number


def whole_number(lowest: int) -> Callable[[str | int], int]:
    """How many: ``lowest`` or more; for ``type=``."""

    def read(value: str | int) -> int:
        text = str(value)
        if not (text.isascii() and text.isdigit() and int(text) >= lowest):
            raise click.BadParameter(f"'{value}' is not a whole number from {lowest} on")
        return int(text)

    return read


def bus_choice() -> BusChoice:
    """What was said about the bus on the command line."""
    return click.get_current_context().ensure_object(BusChoice)


def chosen_url() -> "BusUrl":
    """The bus that the command line and the environment mean.

    Raises:
        UsageError: The URL or the domain is wrong.
    """
    from lcmtools.bus.url import choose_url

    choice = bus_choice()
    url, source = choose_url(choice.url, choice.domain, os.environ, read_user_file(os.environ))
    if choice.domain and source != "--domain":
        talk(f"lcmtools: --domain {choice.domain} has no effect: {source} wins")
    return url


def open_monitor(tool: str, *, whole: bool = False) -> "BusMonitor":
    """A look at the bus that the command line means.

    Args:
        tool: The command's name.
        whole: Large messages are wanted whole; else their heads will do.

    Raises:
        UsageError: The URL or the domain is wrong.
        BusError: The bus cannot be reached, with what to type.
    """
    from lcmtools.observe.monitor import BusMonitor

    def tell(text: str) -> None:
        talk(f"lcmtools {tool}: {text}")

    return BusMonitor(chosen_url(), tool, os.environ, whole=whole, on_outage=tell)


def topic_spellings(name: str) -> list[str]:
    """The channels that a topic's name may mean where it is read; see lcmtools.names.spellings.

    Raises:
        UsageError: The name is empty.
    """
    from lcmtools.names import resolve_namespace, spellings

    if not name:
        raise UsageError("the topic's name is empty", "lcmtools list shows the topics")
    namespace = resolve_namespace(usual_namespace(os.environ))
    return list(dict.fromkeys(spellings(name, namespace)))
