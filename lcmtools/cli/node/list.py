"""``lcmtools node list``."""

import click

from lcmtools.cli.describe import listed_node, node_record
from lcmtools.cli.options import CONTEXT, all_option, bus_options, json_option, open_watch
from lcmtools.cli.output import document, lines, talk


@click.command("list", context_settings=CONTEXT)
@click.argument("namespace", default="")
@all_option
@json_option
@bus_options
def command(namespace: str, *, show_all: bool, as_json: bool) -> None:
    """List the nodes on the bus. A node that was killed or hangs is shown as stale.

    \b
    Examples:
      lcmtools node list
      lcmtools node list /husky0
    """  # noqa: D301 - \b is click's mark
    with open_watch("node_list") as watch:
        graph = watch.settle(foreign=False)
        url = watch.url
    prefix = f"/{namespace.strip('/')}" if namespace.strip("/") else ""
    nodes = [
        node
        for node in graph.nodes
        if (show_all or not node.is_hidden)
        and (not prefix or node.name == prefix or node.name.startswith(f"{prefix}/"))
    ]
    if as_json:
        document([node_record(node) for node in nodes])
    else:
        lines(map(listed_node, nodes))
    if not nodes:
        talk(f"no nodes{f' in {namespace}' if namespace else ''} on {url}")
