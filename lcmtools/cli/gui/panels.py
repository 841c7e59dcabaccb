"""``lcmtools gui`` and its panels."""

import click

from lcmtools.cli.bus import looking_names
from lcmtools.cli.declare import argument, duration, examples, option, subcommand
from lcmtools.cli.gui.window import WindowChoice, open_window, window_options
from lcmtools.names import has_wildcard

_FASTEST = 10.0  # [m/s] and [rad/s], as in ``gui.steering``, which need not be loaded for the help
_limit = click.FloatRange(0.01, _FASTEST)


@subcommand("all", window_options)
@examples("gui", "gui all --port 8000", "gui all --host 192.168.1.20 --read-only")
def all_panels(window: WindowChoice) -> None:
    """Open a window with all panels in the browser, until Ctrl-C.

    Only this computer can open the page, and only you: the printed address contains a token. With
    --host it is open to others, by two addresses, one for watching and one for commanding.
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


@subcommand("services", window_options)
@examples("gui services", "gui services /husky0/reset")
@argument("service", metavar="[SERVICE]", default="", completer="bus:services")
def services(window: WindowChoice, service: str) -> None:
    """Call services in the browser: a form for the request, and the answer."""
    open_window(window, "services", service=looking_names().resolve(service) if service else "")


@subcommand("parameters", window_options)
@examples("gui parameters", "gui parameters /husky0/simple_controller")
@argument("node", metavar="[NODE]", default="", completer="bus:nodes")
def parameters(window: WindowChoice, node: str) -> None:
    """Show the parameters of nodes in the browser, and set them."""
    open_window(window, "parameters", node=looking_names().resolve(node) if node else "")


@subcommand("record", window_options)
@examples("gui record", "gui record /husky0/odometry '/husky0/cmd_*'")
@argument("topics", metavar="[TOPIC]...", nargs=-1, completer="bus:topics")
def record(window: WindowChoice, topics: tuple[str, ...]) -> None:
    """Start and stop a recording in the browser, of topics that are ticked there.

    TOPICs, which may be patterns in quotes, are ticked at first. The log is written as by bag
    record, and complete when the window ends.
    """
    names = looking_names()
    spelled = ([one] if has_wildcard(one) else names.spellings(one) for one in topics)
    open_window(window, "record", topics=[name for some in spelled for name in some])


@subcommand("steer", window_options)
@examples("gui steer /husky0/desired_velocity", "gui steer /cmd_vel --max-linear 0.3")
@argument("topic", metavar="TOPIC", completer="bus:topics")
@option(
    "--max-linear",
    "linear",
    type=_limit,
    help="Maximum speed [m/s]; else 1, and pages may raise it to 10.",
)
@option(
    "--max-angular",
    "angular",
    type=_limit,
    help="Maximum turn rate [rad/s]; else 2, and pages may raise it to 10.",
)
def steer(window: WindowChoice, topic: str, linear: float | None, angular: float | None) -> None:
    """Steer a robot in the browser: joystick, sliders, keys, gamepad.

    The robot drives while a control is held, and stops when it is released, when the page is hidden
    or closed, and when the connection is lost. Messages are Twist, TwistStamped or similar.
    """
    name = looking_names().resolve(topic)
    from lcmtools.gui.steering import SpeedLimits

    limits = SpeedLimits(linear or _FASTEST, angular or _FASTEST)
    speeds = {"linear": linear or 1.0, "angular": angular or 2.0}
    open_window(window, "steer", limits, topic=name, **speeds)


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
