"""Commands of ROS and catkin, and their options."""

from collections.abc import Mapping

NO_BUILD = "lcmtools run NODE starts a node as it is; lcmtools pkg build checks its messages"
_LOG = "lcmtools bag info FILE shows what is in a log, bag plot draws it, bag play publishes it"
_LOOK = "lcmtools gui world shows the robots, gui image a camera's images, gui topics all topics"
_PANELS = (
    "lcmtools gui opens topics, plots, images, the graph and steering in the browser; spy, plot,"
    " graph and run steering do so in the terminal"
)
_COMPRESS = "bag record --compress zstd compresses as it records; zstd and lz4 do so with any log"
_SERVICE_TYPES = "lcmtools srv list lists the service types of all packages"
_NO_QOS = "LCM has no QoS: delivery is best effort"
_NO_DAEMON = "there is no daemon to wait for: the nodes answer at once"
_AS_IT_COMES = "messages are written as they arrive"
_PACK = "--compress zstd or lz4"
_SPLIT = "--split 1GB, or 10m, starts a new file at that size or time"

COMMANDS: Mapping[str, str | tuple[str, ...]] = {
    "bag compress": _COMPRESS,
    "bag convert": "lcmtools bag export writes other formats, bag import reads bags of ROS",
    "bag decompress": _COMPRESS,
    "catkin_init_workspace": NO_BUILD,
    "daemon": "there is none: the nodes answer at once",
    "gazebo": _LOOK,
    "gzclient": _LOOK,
    "gzserver": "lcmtools run sim starts the simulator",
    "param delete": "a node has its parameters for as long as it runs; param set gives one another"
    " value",
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
"""A hint where there is no such command here, or the words in its place."""
OPTIONS: Mapping[str, str] = {
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
PREFIXES = ("ament", "catkin", "colcon", "gz", "ros", "rqt", "rviz", "tf2_")
"""The beginnings of programs' names."""
NOT_MESSAGES = ("roscpp", "rospy", "rclcpp", "rclpy", "message_generation", "message_runtime")
"""Dependencies that have no messages."""
