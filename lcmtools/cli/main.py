"""The command ``lcmtools``: its table of commands, and how one is run."""

import os
import sys
from collections.abc import Sequence

import click

from lcmtools import __version__
from lcmtools.cli.ending import BY_SIGNAL, endable, exit_code, explain, flush, writable
from lcmtools.cli.lazy import Entry, LazyGroup
from lcmtools.cli.options import CONTEXT, bus_options

_TOPIC = "lcmtools.cli.topic"
_TOPIC_COMMANDS = {
    "list": Entry(f"{_TOPIC}.list:command", "List the topics on the bus."),
    "info": Entry(f"{_TOPIC}.info:command", "Show a topic's type, publishers and subscribers."),
    "echo": Entry(f"{_TOPIC}.echo:command", "Print the messages of a topic."),
    "pub": Entry(f"{_TOPIC}.pub:command", "Publish messages written in YAML."),
    "hz": Entry(f"{_TOPIC}.hz:command", "Measure the rate of topics."),
    "bw": Entry(f"{_TOPIC}.bw:command", "Measure the bandwidth of topics."),
    "delay": Entry(f"{_TOPIC}.delay:command", "Measure how late a topic's messages arrive."),
    "type": Entry(f"{_TOPIC}.type:command", "Print a topic's type."),
    "find": Entry(f"{_TOPIC}.find:command", "List the topics of a type."),
}
_NODE_COMMANDS = {
    "list": Entry("lcmtools.cli.node.list:command", "List the nodes on the bus."),
    "info": Entry("lcmtools.cli.node.info:command", "Show a node's publications and more."),
    "machine": Entry("lcmtools.cli.node.machine:command", "List the computers that nodes run on."),
    "ping": Entry("lcmtools.cli.node.ping:command", "Measure how fast a node answers."),
    "cleanup": Entry("lcmtools.cli.node.cleanup:command", "Forget nodes that were killed."),
}
_MSG_COMMANDS = {
    "list": Entry("lcmtools.cli.msg.list:command", "List the message types."),
    "show": Entry("lcmtools.cli.msg.show:command", "Show the fields of a message type."),
    "proto": Entry("lcmtools.cli.msg.proto:command", "Print a message to fill in, for pub."),
    "find-field": Entry("lcmtools.cli.msg.find_field:command", "Find types by a field's name."),
    "package": Entry("lcmtools.cli.msg.package:command", "List the message types of a package."),
    "packages": Entry("lcmtools.cli.msg.packages:command", "List the packages."),
    "fingerprint": Entry("lcmtools.cli.msg.fingerprint:command", "Print a type's fingerprint."),
    "md5": Entry("lcmtools.cli.msg.fingerprint:command", "fingerprint, as ROS.", is_alias=True),
}
_SRV_COMMANDS = {
    "list": Entry("lcmtools.cli.srv.list:command", "List the service types."),
    "show": Entry("lcmtools.cli.srv.show:command", "Show the fields of a service type."),
}
_COMMANDS = {
    **_TOPIC_COMMANDS,
    "node": Entry("lcmtools.cli.main:node", "Look at nodes: list, info, ping and more."),
    "msg": Entry("lcmtools.cli.main:msg", "Look at message types: list, show, proto and more."),
    "srv": Entry("lcmtools.cli.main:srv", "Look at service types: list, show."),
    "wtf": Entry("lcmtools.cli.wtf:command", "Find what is wrong and say how to mend it."),
    "run": Entry("lcmtools.cli.run:command", "Run a node, or the simulator."),
    "topic": Entry("lcmtools.cli.main:topic", "topic list is list, and so on.", is_alias=True),
    "doctor": Entry("lcmtools.cli.wtf:command", "wtf, as ROS 2 names it.", is_alias=True),
    "interface": Entry("lcmtools.cli.main:msg", "msg, as ROS 2 names it.", is_alias=True),
}

_EPILOG = """\b
Examples:
  lcmtools list
  lcmtools echo /husky0/odometry
  lcmtools pub /chatter std_msgs/String "data: hello"

\b
Exit codes: 0 done, 1 failed, 2 wrong usage, 3 an extra is missing, 4 nothing came within
--timeout, 130 Ctrl-C, 143 SIGTERM. A node that is asked to end exits with 0.
"""


def _print_version(ctx: click.Context, _parameter: click.Parameter, value: bool) -> None:  # noqa: FBT001 - click's signature
    if not value or ctx.resilient_parsing:
        return
    from importlib.metadata import version
    from platform import python_version

    click.echo(f"lcmtools {__version__} (lcm {version('lcm')}, Python {python_version()})")
    ctx.exit()


@click.group(
    cls=LazyGroup, entries=_COMMANDS, context_settings=CONTEXT, epilog=_EPILOG, name="lcmtools"
)
@bus_options
@click.option(
    "--version",
    is_flag=True,
    expose_value=False,
    is_eager=True,
    callback=_print_version,
    help="Print the versions of lcmtools, lcm and Python.",
)
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def root(debug: bool) -> None:  # noqa: FBT001 - click's signature
    """See and speak to every program on an LCM bus: topics, nodes, messages, and what is wrong."""
    if debug:
        os.environ["LCMTOOLS_DEBUG"] = "1"


@click.group(cls=LazyGroup, entries=_TOPIC_COMMANDS, context_settings=CONTEXT)
@bus_options
def topic() -> None:
    """Look at topics and publish on them.

    \b
    Examples:
      lcmtools topic list
      lcmtools topic echo /chatter
    """  # noqa: D301 - \b is click's mark


@click.group(cls=LazyGroup, entries=_NODE_COMMANDS, context_settings=CONTEXT)
@bus_options
def node() -> None:
    """Look at nodes.

    \b
    Examples:
      lcmtools node list
      lcmtools node info simple_controller
    """  # noqa: D301 - \b is click's mark


@click.group(cls=LazyGroup, entries=_MSG_COMMANDS, context_settings=CONTEXT)
def msg() -> None:
    """Look at message types.

    \b
    Examples:
      lcmtools msg list
      lcmtools msg show geometry_msgs/Twist
    """  # noqa: D301 - \b is click's mark


@click.group(cls=LazyGroup, entries=_SRV_COMMANDS, context_settings=CONTEXT)
def srv() -> None:
    """Look at service types.

    \b
    Examples:
      lcmtools srv list
      lcmtools srv show std_srvs/Trigger
    """  # noqa: D301 - \b is click's mark


def main(arguments: Sequence[str]) -> int:
    """Run one command; return its exit code."""
    signals: list[int] = []
    try:
        # not root.main(): it answers Ctrl-C with an empty line
        with endable(signals), root.make_context("lcmtools", list(arguments)) as context:
            return exit_code(root.invoke(context))
    except BaseException as error:
        if signals:  # whatever the code that was interrupted has made of it
            return BY_SIGNAL + signals[0]
        code = explain(error, _command_name(arguments))
        if code is None:
            raise
        return code


def run() -> None:
    """The console script."""
    sys.stdout, sys.stderr = writable(sys.stdout), writable(sys.stderr)
    code = main(sys.argv[1:])
    code = flush(code)
    sys.exit(code)


def _command_name(arguments: Sequence[str]) -> str:
    """The command as typed, for messages: "lcmtools node info"."""
    known = {**_COMMANDS, **_NODE_COMMANDS, **_MSG_COMMANDS, **_SRV_COMMANDS}
    words = []
    for word in arguments:
        if word not in known:
            break
        words.append(word)
    return " ".join(["lcmtools", *words])
