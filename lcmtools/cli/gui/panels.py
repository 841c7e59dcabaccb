"""``lcmtools gui`` and its panels."""

import click

from lcmtools.cli.bus import looking_names
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.gui.window import WindowChoice, open_window, window_options

_limit = click.FloatRange(0.01)


@subcommand("all", window_options)
@examples("gui", "gui all --port 8000", "gui all --host 192.168.1.20 --read-only")
def all_panels(window: WindowChoice) -> None:
    """Open a window with all panels in the browser, until Ctrl-C.

    Only this computer can open the page, unless --host opens it to others; then the printed
    addresses contain tokens, one for watching and one for commanding.
    """
    open_window(window)


@subcommand("topics", window_options)
@examples("gui topics", "gui topics --read-only")
def topics(window: WindowChoice) -> None:
    """Show the topics in the browser: rate, bandwidth, loss, senders, messages; and publish."""
    open_window(window, "topics")


@subcommand("log", window_options)
@examples("gui log", "gui log --port 8000")
def log(window: WindowChoice) -> None:
    """Show the nodes' log lines in the browser: by level, node and text."""
    open_window(window, "log")


@subcommand("steer", window_options)
@examples("gui steer /husky0/desired_velocity", "gui steer /cmd_vel --max-linear 0.3")
@argument("topic", metavar="TOPIC", completer="bus:topics")
@option("--max-linear", "linear", type=_limit, default=1.0, help="Maximum speed [m/s] (else 1).")
@option(
    "--max-angular", "angular", type=_limit, default=2.0, help="Maximum turn rate [rad/s] (else 2)."
)
def steer(window: WindowChoice, topic: str, linear: float, angular: float) -> None:
    """Steer a robot in the browser: joystick, sliders, keys, gamepad.

    The robot drives while a control is held, and stops when it is released, when the page is hidden
    or closed, and when the connection is lost. Messages are Twist, TwistStamped or similar.
    """
    name = looking_names().resolve(topic)
    open_window(window, "steer", topic=name, linear=linear, angular=angular)


@subcommand("plot", window_options)
@examples(
    "gui plot /husky0/odometry/twist.twist.linear.x /husky0/desired_velocity/linear.x",
    "gui plot /joint_states/position --window 30s",
)
@argument("fields", metavar="TOPIC/FIELD...", nargs=-1, completer="messages:topics_and_fields")
@option("--window", "length", type=duration, help="The time shown (else 10s, or a whole log).")
def plot(window: WindowChoice, fields: tuple[str, ...], length: float | None) -> None:
    """Plot fields of messages over time in the browser.

    An array gives a curve for each element, a message one for each of its numbers. With --bag the
    whole log is shown, with a line at the current time.
    """
    open_window(window, "plot", fields=list(fields), window=length)


@subcommand("image", window_options)
@examples("gui image /camera/depth/image_raw", "gui image /camera/rgb/image_raw/compressed")
@argument("topic", metavar="TOPIC", completer="bus:topics")
def image(window: WindowChoice, topic: str) -> None:
    """Show the images of a topic in the browser: colour, grey, and depth with its values."""
    open_window(window, "image", topic=topic)


@subcommand("graph", window_options)
@examples("gui graph", "gui graph --read-only")
def graph(window: WindowChoice) -> None:
    """Show the graph in the browser: nodes, topics, rates, and what wtf finds.

    Findings are marked at the nodes and topics concerned, and updated every few seconds.
    """
    open_window(window, "graph")


@subcommand("world", window_options)
@examples("gui world", "gui world --read-only")
def world(window: WindowChoice) -> None:
    """Show the world in 3D in the browser: robots, laser, points, paths, maps, trails.

    If the simulator runs, walls and objects are shown too; robots and crates can be dragged, and
    time can be paused. A click sends a pose.
    """
    open_window(window, "world")
