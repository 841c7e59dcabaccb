"""Options that several commands share, each defined once."""

import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from lcmtools.arguments import NodeArguments, is_assignment, split_arguments
from lcmtools.cli.declare import CommandT, option
from lcmtools.cli.output import talk
from lcmtools.errors import UsageError
from lcmtools.names import Pattern, Resolver, has_wildcard, resolve_namespace, spellings
from lcmtools.settings import COLORS, read_user_file, usual_namespace

if TYPE_CHECKING:  # lcmtools --help and usage errors do without the bus
    from lcmtools.bus.url import BusUrl
    from lcmtools.observe.monitor import BusMonitor

COLOR = "lcmtools.color"  # the key of a click context's ``meta`` for the value of ``--color``


@dataclass(slots=True)
class BusChoice:
    """The bus, and the names that commands look for, as the command line has them."""

    url: str | None = None
    domain: str | None = None
    names: NodeArguments = field(default_factory=NodeArguments)


def _remember(ctx: click.Context, parameter: click.Parameter, value: str | None) -> str | None:
    choice = ctx.ensure_object(BusChoice)
    if value is not None:
        setattr(choice, "url" if parameter.name == "lcm_url" else "domain", value)
    return value


def bus_options(command: CommandT) -> CommandT:
    """Add ``--lcm-url`` and ``--domain``; ``chosen_url`` reads them."""
    url = option(
        "--lcm-url",
        metavar="URL",
        callback=_remember,
        expose_value=False,
        completer="bus:urls",
        help="The bus, for example 'udpm://239.255.76.67:7667?ttl=0' (else LCM_DEFAULT_URL).",
    )
    domain = option(
        "--domain",
        metavar="N",
        callback=_remember,
        expose_value=False,
        help="The bus on port 7667 + N (else LCMTOOLS_DOMAIN). A URL takes precedence.",
    )
    return url(domain(command))


def _remember_names(ctx: click.Context, parameter: click.Parameter, value: object) -> None:
    given = [value] if isinstance(value, str) else value if isinstance(value, tuple) else ()
    _add_names(ctx, [f"{parameter.opts[0]}={word}" for word in given])


def take_names(ctx: click.Context, words: Sequence[str]) -> list[str]:
    """Take ``__ns:=`` and ``a:=b`` out of a looking command's words; return the others."""
    end = [*words, "--"].index("--")
    _add_names(ctx, list(filter(is_assignment, words[:end])))
    return [*(word for word in words[:end] if not is_assignment(word)), *words[end:]]


def _add_names(ctx: click.Context, words: Sequence[str]) -> None:
    said, _ = split_arguments(words)
    if said.parameters or said.name:
        raise UsageError(f"{words[0]} is for nodes", "this command takes __ns:= and a:=b")
    names = ctx.ensure_object(BusChoice).names
    names.namespace = names.namespace if said.namespace is None else said.namespace
    names.remaps += said.remaps


def looking_options(command: CommandT) -> CommandT:
    """Add ``bus_options``, ``--ns`` and ``--remap``; ``looking_names`` and ``in_names`` read them.

    ``LazyGroup`` takes ``__ns:=`` and ``a:=b`` out of the words of the commands that have these.
    """
    ns = option(
        "--ns",
        metavar="NAME",
        completer="bus:namespaces",
        callback=_remember_names,
        expose_value=False,
        help="The namespace of relative names; as __ns:=NAME.",
    )
    remap = option(
        "--remap",
        metavar="FROM:=TO",
        multiple=True,
        completer="programs:remaps",
        callback=_remember_names,
        expose_value=False,
        help="Use TO in place of FROM; as FROM:=TO.",
    )
    return ns(remap(bus_options(command)))


def is_looking(command: click.Command) -> bool:
    """Return whether a command has ``looking_options``."""
    return any(option.name == "ns" and not option.expose_value for option in command.params)


json_option = option("--json", "as_json", is_flag=True, help="Print JSON.")
all_option = option(
    "-a", "--all", "show_all", is_flag=True, help="Show hidden names too (a part starts with '_')."
)


def _choose_color(ctx: click.Context, parameter: click.Parameter, value: str | None) -> None:
    said = ctx.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
    if value and said and not ctx.resilient_parsing:
        os.environ["LCMTOOLS_COLOR"] = value  # for nodes, and the processes that this one starts
        ctx.meta[COLOR] = value


def _debug(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if value and not ctx.resilient_parsing:
        os.environ["LCMTOOLS_DEBUG"] = "1"


def manner_options(*, hidden: bool) -> list[click.Option]:
    """Return ``--color``, ``--no-color`` and ``--debug``; only the root's help shows them."""
    return [
        click.Option(
            ["--color"],
            type=click.Choice(COLORS),
            envvar="LCMTOOLS_COLOR",
            metavar="WHEN",
            callback=_choose_color,
            expose_value=False,
            hidden=hidden,
            help="Colour: auto, always or never (else LCMTOOLS_COLOR, NO_COLOR).",
        ),
        click.Option(
            ["--no-color"],
            flag_value="never",
            callback=_choose_color,
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


def bus_choice() -> BusChoice:
    """Return the bus options of the command line."""
    return click.get_current_context().ensure_object(BusChoice)


def chosen_url() -> "BusUrl":
    """Return the bus that the command line and the environment select."""
    from lcmtools.bus.url import choose_url

    choice = bus_choice()
    url, source = choose_url(choice.url, choice.domain, os.environ, read_user_file(os.environ))
    if choice.domain and source != "--domain":
        talk(f"lcmtools: --domain {choice.domain} has no effect: {source} wins")
    return url


def open_monitor(tool: str, *, whole: bool = False, plays: bool = False) -> "BusMonitor":
    """Open the bus or the log that the command line selects, for the command ``tool``.

    Large messages come as a whole, or only their heads; a log is played at its own speed, or read
    at once. A request to shut down ends the command as SIGTERM does.
    """
    from lcmtools.observe.monitor import BusMonitor

    return BusMonitor(
        chosen_url(),
        tool,
        os.environ,
        whole=whole,
        plays=plays,
        on_outage=lambda text: talk(f"lcmtools {tool}: {text}"),
        on_shutdown=lambda: signal.raise_signal(signal.SIGTERM),
    )


def notify(text: str) -> None:
    """Tell the person something in the name of the command that runs."""
    talk(f"{click.get_current_context().command_path}: {text}")


def looking_names() -> Resolver:
    """The names of a command that looks: its namespace and its remaps."""
    said = bus_choice().names
    namespace = usual_namespace(os.environ) if said.namespace is None else said.namespace
    return Resolver(resolve_namespace(namespace), remaps=tuple(said.remaps))


def looking_pattern(text: str, *, hidden: bool) -> Pattern:
    """A topic, namespace or pattern as a looking command reads it."""
    names = looking_names()
    word = text if has_wildcard(text) else in_names(text)
    return Pattern(word, names.namespace, hidden=hidden)


def in_names(word: str) -> str:
    """A node, service, namespace or pattern as the command line's own ``--ns`` and remaps have it.

    Where neither is given the word stays as it is, for it may be a name's last part or a pid.
    """
    said, names = bus_choice().names, looking_names()
    if not word or not (said.namespace or said.remaps):
        return word
    found = names.spellings(word)[-1]
    if said.namespace and has_wildcard(word) and not word.startswith("/"):
        return f"{names.namespace.rstrip('/')}/{word}"
    is_remapped = found != spellings(word, names.namespace)[-1]
    return found if said.namespace or is_remapped else word
