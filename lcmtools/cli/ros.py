"""Commands of ROS and catkin that are typed behind ``lcmtools``, and what takes their place.

Imported only where a command or an option is unknown.
"""

import shlex
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.cli.output import talk
from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean

_NO_BUILD = "lcmtools run NODE starts a node as it is; lcmtools pkg build checks its messages"
_LOG = "lcmtools bag info FILE shows what is in a log, bag plot draws it, bag play publishes it"
_LOOK = "lcmtools gui world shows the robots, gui image a camera's images, gui topics all topics"
_PANELS = (
    "lcmtools gui opens topics, plots, images, the graph and steering in the browser; spy, plot,"
    " graph and run steering do so in the terminal"
)
_COMPRESS = "bag record --compress zstd compresses as it records; zstd and lz4 do so with any log"
_SERVICE_TYPES = "lcmtools srv list lists the service types of all packages"
_NOT_MESSAGES = ("roscpp", "rospy", "rclcpp", "rclpy", "message_generation", "message_runtime")


def _create_package(words: Sequence[str]) -> list[str]:
    """As catkin_create_pkg NAME roscpp rospy std_msgs: of the dependencies those with messages."""
    from lcmtools.messages.registry import packages

    name, *others = [word for word in words if not word.startswith("-")] or [""]
    known = [word for word in others if word in packages()]
    if unknown := [word for word in others if word not in (*known, *_NOT_MESSAGES)]:
        talk(f"lcmtools pkg create: no messages in {', '.join(unknown)}, which is left out")
    return ["pkg", "create", *([name] if name else []), *(["--deps", *known] if known else [])]


def _build(words: Sequence[str]) -> list[str]:
    """As catkin build NAME, catkin_make: options of compilers have no use."""
    names = [word for word in words if word[:1].isalpha()]
    return ["pkg", "build", *names[:1]]


def _catkin(words: Sequence[str]) -> list[str]:
    verb, rest = words[0] if words else "", words[1:]
    if verb == "build":
        return _build(rest)
    if verb == "create":  # catkin create pkg NAME
        return _create_package(rest[1:])
    raise UsageError(f"a workspace needs no catkin {verb}".rstrip(), _NO_BUILD)


def _run(words: Sequence[str]) -> list[str]:
    """As rosrun PACKAGE NODE; a package that is not there may be ROS's own with a node of ours."""
    from lcmtools.packages.runnable_nodes import OWN, runnables

    known = runnables(Path.cwd())
    if len(words) < 2 or words[0] in {node.package for node in known}:  # noqa: PLR2004 - both
        return ["run", *words]
    _, name, *rest = words
    if name in {node.name for node in known if node.package == OWN}:
        return ["run", name, *rest]
    found = _INSTEAD.get(name.removesuffix(".py"))
    return ["run", *words] if found is None else _replaced(name, found, rest)


def _ros2(words: Sequence[str]) -> list[str]:
    """As ros2 run PACKAGE NODE --ros-args -r a:=b, where remaps need no --ros-args here."""
    if list(words[:1]) == ["run"]:
        return _run([word for word in words[1:] if word != "--ros-args"])
    return list(words) or ["help"]


def _image_view(words: Sequence[str]) -> list[str]:
    """As rqt_image_view TOPIC: the topic stands first, and what follows is the node's own."""
    is_topic = bool(words) and not words[0].startswith("-") and ":=" not in words[0]
    return ["run", "image_view", *([f"image:={words[0]}"] if is_topic else []), *words[is_topic:]]


Instead = str | tuple[str, ...] | Callable[[Sequence[str]], list[str]]
"""A hint where there is no such command; or the words in its place, or a function of the rest."""

_INSTEAD: Mapping[str, Instead] = {
    "bag compress": _COMPRESS,
    "bag convert": "lcmtools bag export writes other formats, bag import reads bags of ROS",
    "bag decompress": _COMPRESS,
    "catkin": _catkin,
    "catkin_create_pkg": _create_package,
    "catkin_init_workspace": _NO_BUILD,
    "catkin_make": _build,
    "catkin_make_isolated": _build,
    "colcon": lambda words: _build(words[1:]),
    "daemon": "there is none: the nodes answer at once",
    "gazebo": _LOOK,
    "gzclient": _LOOK,
    "gzserver": "lcmtools run sim starts the simulator",
    "image_view": _image_view,
    "param delete": "a node has its parameters for as long as it runs; param set gives one another"
    " value",
    "ros2": _ros2,
    "rosbag": ("bag",),
    "roscd": 'cd "$(lcmtools pkg find NAME)"',
    "rosclean": "each launch keeps its logs in ~/.local/state/lcmtools/log",
    "roscore": "LCM has no master: start the nodes, for example lcmtools run sim",
    "rosdep": "a package's Python dependencies are in its pyproject.toml; pip installs them",
    "roslaunch": ("launch",),
    "rosmaster": "LCM has no master: start the nodes, for example lcmtools run sim",
    "rosmsg": ("msg",),
    "rosnode": ("node",),
    "rospack": ("pkg",),
    "rosparam": ("param",),
    "rosrun": _run,
    "rosservice": ("service",),
    "rossrv": ("srv",),
    "rostest": "pytest runs a package's tests; lcmtools lab check checks the programs of a lab",
    "rostopic": ("topic",),
    "rosversion": "lcmtools --version",
    "roswtf": ("wtf",),
    "rqt": _PANELS,
    "rqt_bag": _LOG,
    "rqt_console": ("echo", "/rosout"),
    "rqt_graph": ("graph",),
    "rqt_gui": _PANELS,
    "rqt_image_view": _image_view,
    "rqt_plot": "lcmtools gui plot TOPIC/FIELD draws in the browser, lcmtools plot in the terminal",
    "rqt_reconfigure": "lcmtools param list -v shows the parameters, param set changes one",
    "rqt_robot_steering": "lcmtools gui steer TOPIC, or run steering TOPIC in the terminal",
    "rqt_topic": ("spy",),
    "rviz": _LOOK,
    "rviz2": _LOOK,
    "service node": "lcmtools service info NAME shows the node, its host and its process",
    "service uri": "lcmtools service info NAME shows the node, its host and its process",
    "source": "nothing needs to be sourced: lcmtools finds packages from the current folder",
    "srv md5": "lcmtools msg md5 NAME_Request, and NAME_Response, print the fingerprints",
    "srv package": _SERVICE_TYPES,
    "srv packages": _SERVICE_TYPES,
    "teleop_twist_keyboard": ("run", "teleop"),
    "tf_echo": "lcmtools echo /tf",
    "turtlesim": "lcmtools run sim starts a simulated robot, lcmtools lab list shows the labs",
}
_NO_QOS = "LCM has no QoS: delivery is best effort"
_NO_DAEMON = "there is no daemon to wait for: the nodes answer at once"
_AS_IT_COMES = "messages are written as they arrive"
_PACK = "--compress zstd or lz4"
_SPLIT = "--split 1GB, or 10m, starts a new file at that size or time"
_OPTIONS: Mapping[str, str] = {
    "--include-hidden-topics": "lcmtools list --all lists the hidden ones too",
    "--no-daemon": _NO_DAEMON,
    "--qos": _NO_QOS,
    "--spin-time": _NO_DAEMON,
    "--stdin": "- in place of the values reads standard input",
    "--tcpnodelay": "LCM uses UDP",
    "--yaml-file": "-f reads messages from a file",
    "bag filter -p": "lcmtools echo -b FILE --filter EXPR prints them",
    "bag filter --print": "lcmtools echo -b FILE --filter EXPR prints them",
    "bag info --freq": "the rates are shown without it",
    "bag info -y": "--json is for programs",
    "bag info --yaml": "--json is for programs",
    "bag play --bags": "each word is a log; -t may be repeated",
    "bag play -d": "nothing has to connect; -w waits for subscribers",
    "bag play --delay": "nothing has to connect; -w waits for subscribers",
    "bag play --hz": "--clock publishes 100 times a second",
    "bag play -i": "-r 0 is as fast as possible",
    "bag play --immediate": "-r 0 is as fast as possible",
    "bag play -k": "LCM does not keep latched messages for later subscribers",
    "bag play --keep-alive": "LCM does not keep latched messages for later subscribers",
    "bag play --pause-topics": "SPACE pauses and resumes, . plays one message",
    "bag play --prefix": "--ns /replay puts all topics below /replay",
    "bag play --queue": "there is no queue: each message is sent when it is due",
    "bag play --rate-control-topic": "-r, and the keys up and down, set the rate",
    "bag play --skip-empty": "the right arrow goes on by 5 s, ] by a minute",
    "bag record -b": _AS_IT_COMES,
    "bag record --bz2": _PACK,
    "bag record --buffsize": _AS_IT_COMES,
    "bag record --chunksize": _AS_IT_COMES,
    "bag record -e": "TOPIC may be a pattern in quotes: '/husky*/**'",
    "bag record -j": _PACK,
    "bag record --lz4": _PACK,
    "bag record --max-bag-duration": _SPLIT,
    "bag record --max-bag-size": _SPLIT,
    "bag record --regex": "TOPIC may be a pattern in quotes: '/husky*/**'",
    "bag record --repeat-latched": "each file of --split begins with what is latched",
    "bag record --size": _SPLIT,
    "launch -p": "LCM has no master; --lcm-url and --domain choose the bus",
    "launch --required": "required is a key of a node in the file",
    "run --prefix": "put it in front: gdb --args lcmtools run NODE",
}
"""Hints for the options of ROS: of every command, or of one."""
_PREFIXES = ("ament", "catkin", "colcon", "gz", "ros", "rqt", "rviz", "tf2_")


def instead(group: str, words: Sequence[str]) -> list[str]:
    """Return the words that take the place of a command of ROS; none for what is no such command.

    ``group`` is the one that it is typed in, such as "param"; "" for ``lcmtools`` itself.

    Raises:
        UsageError: There is no such command here; with what takes its place.
    """
    name, *rest = words
    found = _INSTEAD.get(f"{group} {name}".strip())
    if found is None:
        if group or not name.startswith(_PREFIXES):
            return []
        found = did_you_mean(name, _INSTEAD) or "lcmtools --help lists the commands"
    replaced = _replaced(name, found, rest)
    talk(f"{name} is here: lcmtools {shlex.join(replaced)}")
    return replaced


def _replaced(name: str, found: Instead, rest: Sequence[str]) -> list[str]:
    if isinstance(found, str):
        raise UsageError(f"no such command '{name}'", found)
    return [*found, *rest] if isinstance(found, tuple) else found(rest)


def option_instead(command: str, name: str) -> str:
    """Return what takes the place of an option of ROS, as a hint; "" for what is no such option.

    Args:
        command: The command that it was typed for, such as "lcmtools topic hz".
        name: The option, such as "--tcpnodelay".
    """
    family = name if not name.startswith("--qos") else "--qos"
    return _OPTIONS.get(f"{command.partition(' ')[2]} {name}") or _OPTIONS.get(family, "")
