"""Running a plan: on which bus, with which output, and the table of ends."""

import os
import shlex
import sys
from dataclasses import replace

from lcmtools.bus.preflight import wait_for_bus
from lcmtools.bus.url import domain_url
from lcmtools.cli.bus import chosen_url
from lcmtools.cli.output import data, say, talk
from lcmtools.color import BOLD_RED, paint, stream_wants_color
from lcmtools.errors import UsageError
from lcmtools.launch.logs import make_folder
from lcmtools.launch.node_process import NodeProcess
from lcmtools.launch.plan import NodePlan, Output, Plan
from lcmtools.launch.supervisor import Supervisor
from lcmtools.processes.child import StopTimeouts
from lcmtools.text_table import text_table

_COLORS = ("36", "32", "35", "34", "33")  # of nodes in turn: red is for what is wrong


def notify(*texts: str) -> None:
    """Tell the person something in the name of the command."""
    for text in texts:
        talk(f"lcmtools launch: {text}")


def run(plan: Plan, output: str | None, timeouts: StopTimeouts, *, wait: bool) -> int:
    """Run the nodes of a plan until all have ended; return the exit code.

    ``output`` is "screen" or "log" for all nodes; None as the file has it. With ``wait`` they wait
    for a working bus first.
    """
    url = chosen_url()
    notify(*plan.notes)
    if wait:
        wait_for_bus(url, notify)
    if not plan.nodes:
        hint = "lcmtools launch --dry-run shows it"
        raise UsageError("the launch file has no nodes to run", hint)
    nodes = [_with_bus(_with_output(node, output)) for node in plan.nodes]
    # a node's print comes at once, as it would on a terminal
    environment = {"PYTHONUNBUFFERED": "1", **os.environ, "LCM_DEFAULT_URL": str(url)}
    folder = make_folder(os.environ)
    hidden = any(node.output is Output.LOG for node in nodes)
    talk(f"log files: {folder}{'; --screen shows all lines here too' if hidden else ''}")
    ended = Supervisor(nodes, environment, folder, Screen(), timeouts).run()
    sys.stdout.flush()
    rows = [("node", "end", "restarts", "log")]
    for one in ended:
        log = shlex.quote(one.log) if one.log else "-"
        rows.append((one.plan.name, one.end_text(), str(max(0, one.starts - 1)), log))
    for row in text_table(rows):
        talk(row)
    return int(any(one.has_failed for one in ended))


def _with_output(node: NodePlan, output: str | None) -> NodePlan:
    if output is None:
        return node
    return replace(node, output=Output.BOTH if output == "screen" else Output.LOG)


def _with_bus(node: NodePlan) -> NodePlan:
    """Return a node on the domain that its file sets, if any, and not on the launcher's bus."""
    domain = node.environment.get("LCMTOOLS_DOMAIN")
    if not domain or "LCM_DEFAULT_URL" in node.environment:
        return node
    url = str(domain_url(domain, f"{node.place}: LCMTOOLS_DOMAIN"))
    return replace(node, environment={**node.environment, "LCM_DEFAULT_URL": url})


class Screen:
    """Shows the lines and events of a supervisor on one screen, with prefixes and colours.

    Lines of a node's error stream and events go to standard error, the rest to standard output.
    """

    def __init__(self) -> None:
        self._colors_lines = stream_wants_color(sys.stdout, os.environ)
        self._colors_talk = stream_wants_color(sys.stderr, os.environ)

    def line(self, node: NodeProcess, text: str, *, is_error: bool) -> None:
        """Show a line that a node has written, unchanged."""
        prefix = f"[{node.label}]"
        if self._colors_talk if is_error else self._colors_lines:
            prefix = paint(prefix, _COLORS[node.number % len(_COLORS)])
        if not is_error:
            data(f"{prefix} {text}")
            return
        say(f"{prefix} {text}\n")

    def stream(self, *, is_error: bool) -> int:
        """Return the descriptor that is written to."""
        return (sys.stderr if is_error else sys.stdout).fileno()

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Show an event of the processes."""
        if is_bad and self._colors_talk:
            say(f"{paint(text, BOLD_RED)}\n")
        else:
            talk(text)
