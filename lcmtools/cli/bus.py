"""The bus and the names that the command line selects."""

import contextlib
import os
import signal
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from lcmtools.cli.options import bus_choice
from lcmtools.cli.output import write_note
from lcmtools.errors import UsageError
from lcmtools.names import Pattern, Resolver, has_wildcard, resolve_namespace, spellings
from lcmtools.settings import read_user_file, usual_namespace

if TYPE_CHECKING:  # --help and usage errors do not need the bus
    from lcmtools.bus.tap import Tap
    from lcmtools.bus.url import BusUrl
    from lcmtools.graph.model import Graph
    from lcmtools.observe.reading.monitor import BusMonitor
    from lcmtools.observe.reading.sources import LogObserver


def chosen_url() -> "BusUrl":
    """Return the bus that the command line and the environment select."""
    from lcmtools.bus.url import choose_url

    choice = bus_choice()
    file = read_user_file(os.environ)
    url, source = choose_url(choice.url, choice.domain, os.environ, file)
    if file.problem:
        write_note(f"lcmtools: {file.problem}; going on without settings")
    if choice.domain and source != "--domain":
        write_note(f"lcmtools: --domain {choice.domain} has no effect: {source} takes precedence")
    return with_notes(url, source)


def with_notes(url: "BusUrl", source: str) -> "BusUrl":
    """Return a URL; write a note for each of its options that has no effect."""
    from lcmtools.bus.url import misread_options

    for note in misread_options(url, source):
        write_note(f"lcmtools: {note}")
    return url


def chosen_logs() -> list[str]:
    """Return the logs that the command line names instead of the bus.

    Raises:
        UsageError: It names a bus, too; or a part of a log, and no log.
    """
    choice = bus_choice()
    if choice.logs and (choice.url or choice.domain):
        hint = "leave out --lcm-url and --domain"
        raise UsageError("-b reads a log instead of the bus", hint)
    if choice.part and not choice.logs:
        raise UsageError(f"--{next(iter(choice.part))} is for logs", "name one with -b")
    return choice.logs


def log_observer(paths: "Sequence[str]") -> "LogObserver":
    """Open logs, or the part of them that the command line selects."""
    from lcmtools.observe.reading.sources import LogObserver

    part = bus_choice().part
    observer = LogObserver(*paths, last=part.get("last"))
    if "start" in part or "end" in part:
        from lcmtools.bag.times import time_window

        span = observer.logs.span()
        observer.logs.between = time_window(span, part.get("start"), part.get("end"))
    return observer


def open_monitor(
    tool: str,
    *,
    whole: bool = False,
    plays: bool = False,
    logs: "Sequence[str]" = (),
    asks: bool = False,
) -> "BusMonitor":
    """Open the bus or the log that the command line selects, for the command ``tool``.

    Large messages come as a whole, or only their heads; a log is played at its own speed, or read
    at once, as ``logs`` and those of ``--bag`` are. A request to shut down ends the command as
    SIGTERM does. ``asks`` is for commands that wait for all nodes: these answer while the rest is
    imported.
    """
    if logs := logs or chosen_logs():
        from lcmtools.bus.url import BusUrl
        from lcmtools.observe.reading.monitor import BusMonitor

        return BusMonitor(BusUrl("file", ",".join(logs)), tool, os.environ, log_observer(logs))
    url = chosen_url()
    observer = _asking(url) if asks and url.is_multicast else None
    asked = time.monotonic() if observer else 0.0
    from lcmtools.observe.reading.monitor import BusMonitor

    return BusMonitor(
        url,
        tool,
        os.environ,
        observer,
        whole=whole,
        plays=plays,
        on_outage=lambda text: write_note(f"lcmtools {tool.replace('_', ' ')}: {text}"),
        on_shutdown=lambda: signal.raise_signal(signal.SIGTERM),
        asked=asked,
    )


def _asking(url: "BusUrl") -> "Tap":
    """Return a tap that has requested all nodes to announce themselves."""
    from lcmtools.bus.quick_probe import PROBE_CHANNEL, PROBE_PAYLOAD
    from lcmtools.bus.tap import Tap

    with contextlib.ExitStack() as opened:
        tap = opened.enter_context(Tap(url))
        tap.send(PROBE_CHANNEL, PROBE_PAYLOAD)
        opened.pop_all()
    return tap


def look(tool: str, *, foreign: bool = False) -> "tuple[Graph, BusUrl]":
    """Return the graph of the bus that the command line selects, and the bus's URL.

    ``foreign``: wait for programs that are no nodes, too.
    """
    with open_monitor(tool, asks=True) as monitor:
        return monitor.settle(foreign=foreign), monitor.url


def notify(text: str) -> None:
    """Write a note of the running command; of lcmtools on a thread without a click context."""
    context = click.get_current_context(silent=True)
    write_note(f"{context.command_path if context else 'lcmtools'}: {text}")


def notify_damage(monitor: "BusMonitor") -> None:
    """Write a note if the log that was read has bytes that belong to no message."""
    if monitor.logs and (damage := monitor.logs.damage()):
        notify(damage)


def notify_starting(graph: "Graph", url: "BusUrl") -> None:
    """Write a note for each node that was started a moment ago and is not on the bus yet."""
    from lcmtools.observe.reading.starting import starting_nodes

    for node in starting_nodes(url, {node.pid for node in graph.nodes}):
        notify(f"{node} is starting: list again in two seconds")


def looking_names() -> Resolver:
    """Return the namespace and the remaps of an observing command."""
    given = bus_choice().names
    namespace = usual_namespace(os.environ) if given.namespace is None else given.namespace
    return Resolver(resolve_namespace(namespace), remaps=given.remaps)


def looking_pattern(text: str, *, hidden: bool) -> Pattern:
    """Return a topic, namespace or pattern as a pattern of full names."""
    names = looking_names()
    word = text if has_wildcard(text) else in_names(text)
    return Pattern(word, names.namespace, hidden=hidden)


def in_names(word: str) -> str:
    """Apply ``--ns`` and the remaps to a pattern, or to the name of a node, service or namespace.

    Without them the word is unchanged: it may be the last part of a name, or a pid.
    """
    given, names = bus_choice().names, looking_names()
    if not word or not (given.namespace or given.remaps):
        return word
    found = names.spellings(word)[-1]
    if given.namespace and has_wildcard(word) and not word.startswith("/"):
        return f"{names.namespace.rstrip('/')}/{word}"
    is_remapped = found != spellings(word, names.namespace)[-1]
    return found if given.namespace or is_remapped else word
