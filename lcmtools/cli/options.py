"""Options that several commands share, each defined once."""

import os
from collections.abc import Callable, Sequence
from itertools import compress, pairwise
from typing import Any

import click
from click.core import ParameterSource

from lcmtools.arguments import NodeArguments, is_assignment, split_arguments
from lcmtools.cli.declare import CommandT, duration, flag, option, rate, together, whole_number
from lcmtools.errors import UsageError
from lcmtools.settings import COLORS

COLOR = "lcmtools.color"  # the key of a click context's ``meta`` for the value of ``--color``


class BusChoice:
    """The bus, namespace and remaps of the command line."""

    url: str | None = None
    domain: str | None = None

    def __init__(self) -> None:
        self.names = NodeArguments()
        self.logs: list[str] = []  # read instead of the bus
        self.part: dict[str, Any] = {}  # of the logs: "start" and "end" (``LogTime``), "last"


def _remember(ctx: click.Context, parameter: click.Parameter, value: str | None) -> str | None:
    choice = ctx.ensure_object(BusChoice)
    if value is not None:
        setattr(choice, "url" if parameter.name == "lcm_url" else "domain", value)
    return value


bus_options = together(
    option(
        "--lcm-url",
        metavar="URL",
        callback=_remember,
        expose_value=False,
        completer="bus:urls",
        help="The bus, for example 'udpm://239.255.76.67:7667?ttl=0' (else LCM_DEFAULT_URL).",
    ),
    option(
        "--domain",
        metavar="N",
        callback=_remember,
        expose_value=False,
        help="The bus on port 7667 + N (else LCMTOOLS_DOMAIN). --lcm-url takes precedence.",
    ),
)
"""``--lcm-url`` and ``--domain``; ``chosen_url`` reads them."""


def _remember_names(ctx: click.Context, parameter: click.Parameter, value: object) -> None:
    given = [value] if isinstance(value, str) else value if isinstance(value, tuple) else ()
    _add_names(ctx, [f"{parameter.opts[0]}={word}" for word in given])


def extract_names(ctx: click.Context, words: Sequence[str]) -> list[str]:
    """Apply ``__ns:=`` and ``a:=b`` of an observing command, and return the other words."""
    end = [*words, "--"].index("--")
    pairs = list(pairwise(["", *words[:end]]))  # after --remap it is the option's value
    taken = [is_assignment(word) and before != "--remap" for before, word in pairs]
    _add_names(ctx, list(compress(words, taken)))
    return [
        *(word for (_, word), is_taken in zip(pairs, taken, strict=True) if not is_taken),
        *words[end:],
    ]


def _add_names(ctx: click.Context, words: Sequence[str]) -> None:
    given, _ = split_arguments(words)
    if given.parameters or given.name:
        raise UsageError(f"{words[0]} is for nodes", "this command takes __ns:= and a:=b")
    choice = ctx.ensure_object(BusChoice)
    namespace = choice.names.namespace if given.namespace is None else given.namespace
    choice.names = NodeArguments(namespace, remaps=choice.names.remaps + given.remaps)


names_options = together(
    option(
        "--ns",
        metavar="NAME",
        completer="bus:namespaces",
        callback=_remember_names,
        expose_value=False,
        help="The namespace of relative names; as __ns:=NAME.",
    ),
    option(
        "--remap",
        metavar="FROM:=TO",
        multiple=True,
        completer="runnables:remaps",
        callback=_remember_names,
        expose_value=False,
        help="Use TO in place of FROM; as FROM:=TO.",
    ),
)
"""``--ns`` and ``--remap``, which ``BusChoice.names`` then has."""


def _remember_logs(ctx: click.Context, parameter: click.Parameter, value: Sequence[str]) -> None:
    if value and parameter.hidden:  # type: ignore[attr-defined] # it is an option
        raise UsageError("a log cannot answer", "leave out -b to ask the nodes on the bus")
    ctx.ensure_object(BusChoice).logs += value


def _remember_part(ctx: click.Context, parameter: click.Parameter, value: object) -> None:
    if value is not None:
        ctx.ensure_object(BusChoice).part[str(parameter.name)] = value


def log_time(text: object) -> object:
    """Return the time within a log that an option's text means."""
    from lcmtools.bag.times import parse_time

    return parse_time(text) if isinstance(text, str) else text


def _bag_option(*, hidden: bool) -> Callable[[CommandT], CommandT]:
    return option(
        "-b",
        "--bag",
        metavar="FILE",
        multiple=True,
        callback=_remember_logs,
        expose_value=False,
        hidden=hidden,
        help="Read an LCM log instead of the bus; several, as of a split, are read as one.",
        completer="files",
    )


def _part_option(*names: str, kind: Callable[..., object], text: str) -> Callable[..., Any]:
    metavar = "TIME" if kind is log_time else "N"
    return option(
        *names, metavar=metavar, type=kind, callback=_remember_part, expose_value=False, help=text
    )


def part_options(*, short: bool = True) -> Callable[[CommandT], CommandT]:
    """Return ``--start``, ``--end`` and ``--last`` for logs; ``-s`` and ``-e`` if ``short``."""
    start, end = (["-s"], ["-e"]) if short else ([], [])
    return together(
        _part_option(*start, "--start", kind=log_time, text="A log from this time: 10s, end-5s."),
        _part_option(*end, "--end", kind=log_time, text="A log up to this time."),
        _part_option("--last", kind=whole_number(1), text="A log's last N messages of each topic."),
    )


bag_option = _bag_option(hidden=False)
"""``--bag`` of commands that can do without anybody's answer; ``open_monitor`` reads it."""
looking_options = together(names_options, bus_options, bag_option, part_options())
"""The options of commands that look at a bus or a log; ``looking_names``, ``in_names`` read them.

``LazyGroup`` takes ``__ns:=`` and ``a:=b`` out of the words of the commands that have these.
"""
looking_options_of_list = together(
    names_options, bus_options, bag_option, part_options(short=False)
)
"""The same for ``list``, whose ``-s`` is that of rostopic."""
asking_options = together(names_options, bus_options, _bag_option(hidden=True))
"""The options of commands that ask nodes, which a log cannot answer."""


def is_looking(command: click.Command) -> bool:
    """Return whether a command observes with a namespace and remaps; pub, a node, does not."""
    names = {parameter.name for parameter in command.params if not parameter.expose_value}
    return "ns" in names and command.name != "pub"


def rate_option(verb: str) -> Callable[[CommandT], CommandT]:
    """Return the option ``--rate`` for a command that repeats an action."""
    return option("-r", "--rate", type=rate, help=f"{verb} at this rate [Hz] until Ctrl-C.")


def times_option(verb: str) -> Callable[[CommandT], CommandT]:
    """Return the option ``--times`` of a command that repeats an action."""
    text = f"{verb} N times, at 1 Hz or -r."
    return option("-t", "--times", metavar="N", type=whole_number(1), help=text)


def timeout_option(seconds: float) -> Callable[[CommandT], CommandT]:
    """Return the option ``--timeout`` of a command that waits for an answer."""
    text = f"Maximum time to wait for an answer (else {seconds:g}s)."
    return option("--timeout", type=duration, default=seconds, help=text)


exclude_option = option(
    "-x",
    "--exclude",
    metavar="TOPIC",
    multiple=True,
    help="Leave out a topic, or what a pattern matches.",
    completer="bus:topics",
)
json_option = flag("--json", "as_json", help="Print JSON.")
all_option = flag("-a", "--all", "show_all", help="Show hidden names too (a part starts with '_').")


def _choose_color(ctx: click.Context, parameter: click.Parameter, value: str | None) -> None:
    given = ctx.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
    if value and given and not ctx.resilient_parsing:
        os.environ["LCMTOOLS_COLOR"] = value  # for nodes and child processes
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
