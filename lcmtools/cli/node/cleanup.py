"""``lcmtools node cleanup``."""

from lcmtools.cli.declare import option, subcommand
from lcmtools.cli.options import bus_options, json_option, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.graph.model import Staleness


@subcommand("cleanup")
@option("-y", "--yes", is_flag=True, expose_value=False, help="Changes nothing: nothing is asked.")
@json_option
@bus_options
def command(*, as_json: bool) -> None:
    """Forget the nodes that ended without saying goodbye, and print their names.

    A node that runs and does not answer is not forgotten; so there is nothing to ask before.

    \b
    Examples:
      lcmtools node cleanup
      lcmtools node cleanup --domain 3
    """
    with open_monitor("node_cleanup") as monitor:
        nodes = monitor.settle(foreign=False).nodes
        ended = [node for node in nodes if node.stale is Staleness.ENDED]
        for node in ended:
            monitor.forget(node)
    names = [node.name for node in ended]
    document(names) if as_json else lines(names)
    if not ended:
        talk("no node has ended without saying goodbye")
