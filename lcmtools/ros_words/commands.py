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
_NO_ACTIONS = "LCM has no actions: publish goal and result as messages, or write a service"
_TF_ECHO = "lcmtools tf echo SOURCE TARGET prints a pose, lcmtools echo /tf the messages"
_NO_ENVIRONMENT = "no terminal needs to be prepared: there is nothing to source or to load"
_NO_INSTALLATION = "no package of ROS needs to be installed; lcmtools run --list shows the nodes"
_ONE_PROGRAM = "lcmtools run starts a node as a program of its own, lcmtools node kill ends it"
_PACKAGES = "lcmtools pkg list shows the packages; their dependencies are in pyproject.toml"
_WORLDS = "lcmtools lab start NAME starts a lab's simulator, lcmtools run sim WORLD any world"
_PACK = "--compress zstd or lz4"
_SPLIT = "--split 1GB, or 10m, starts a new file at that size or time"

COMMANDS: Mapping[str, str | tuple[str, ...]] = {
    "action": _NO_ACTIONS,
    "apt": _NO_INSTALLATION,
    "apt-get": _NO_INSTALLATION,
    "bag burst": "lcmtools bag play plays one message for each ., after SPACE",
    "bag compress": _COMPRESS,
    "bag convert": "lcmtools bag export writes other formats, bag import reads bags of ROS",
    "bag decompress": _COMPRESS,
    "bag decrypt": "logs are not encrypted",
    "bag encrypt": "logs are not encrypted",
    "catkin_init_workspace": NO_BUILD,
    "component": _ONE_PROGRAM,
    "daemon": "there is none: the nodes answer at once",
    "gazebo": _LOOK,
    "gz": _LOOK,
    "gzclient": _LOOK,
    "gzserver": "lcmtools run sim starts the simulator",
    "ign": _LOOK,
    "lifecycle": _ONE_PROGRAM,
    "load_ros": _NO_ENVIRONMENT,
    "module": _NO_ENVIRONMENT,
    "morse": _WORLDS,
    "msg users": "lcmtools find TYPE lists the topics of a type",
    "multicast": "lcmtools wtf checks whether multicast works",
    "param delete": "a node has its parameters for as long as it runs; param set gives one another"
    " value",
    "pkg depends": _PACKAGES,
    "pkg depends-on": _PACKAGES,
    "pkg depends1": _PACKAGES,
    "pkg executables": "lcmtools run --list lists the nodes, lcmtools run PACKAGE those of one",
    "pkg langs": "nodes are written in Python; plain LCM programs in any language take part",
    "pkg list-names": "lcmtools pkg list shows the packages",
    "pkg plugins": _PACKAGES,
    "pkg profile": _PACKAGES,
    "pkg rosdep": _PACKAGES,
    "pkg xml": _PACKAGES,
    "rosbag": ("bag",),
    "rosclean": "each launch keeps its logs in ~/.local/state/lcmtools/log",
    "roscore": "LCM has no master: start the nodes, for example lcmtools run sim",
    "roscp": 'cp "$(lcmtools pkg find NAME)/FILE" .',
    "rosdep": "a package's Python dependencies are in its pyproject.toml; pip installs them",
    "rosed": 'nano "$(lcmtools pkg find NAME)/FILE"',
    "rosinstall": "git clone gets a package; lcmtools run finds it in the current folder",
    "roslaunch": ("launch",),
    "rosls": 'ls "$(lcmtools pkg find NAME)"',
    "rosmake": ("pkg", "build"),
    "rosmaster": "LCM has no master: start the nodes, for example lcmtools run sim",
    "rosmsg": ("msg",),
    "rosnode": ("node",),
    "rospack": ("pkg",),
    "rosparam": ("param",),
    "rospub": ("pub",),
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
    "rqt_reconfigure": "lcmtools gui parameters, in the browser; lcmtools param set in a shell",
    "rqt_robot_steering": "lcmtools gui steer TOPIC, or run steering TOPIC in the terminal",
    "rqt_service_caller": "lcmtools gui services, in the browser; lcmtools service call in a shell",
    "rqt_tf_tree": ("tf", "tree"),
    "rqt_topic": ("spy",),
    "rviz": _LOOK,
    "rviz2": _LOOK,
    "security": "LCM has no security: lcmtools relay connects buses that you keep apart",
    "service echo": "lcmtools service info NAME shows the node, service call NAME calls it",
    "service node": "lcmtools service info NAME shows the node, its host and its process",
    "service uri": "lcmtools service info NAME shows the node, its host and its process",
    "source": _NO_ENVIRONMENT,
    "srv md5": "lcmtools msg md5 NAME_Request, and NAME_Response, print the fingerprints",
    "srv package": _SERVICE_TYPES,
    "srv packages": _SERVICE_TYPES,
    "static_transform_publisher": "lcmtools pub -r 10 /tf tf2_msgs/TFMessage publishes transforms",
    "sudo": _NO_INSTALLATION,
    "teleop_twist_keyboard": ("run", "teleop"),
    "test": "pytest runs a package's tests; lcmtools lab check checks the programs of a lab",
    "tf2_echo": _TF_ECHO,
    "tf2_monitor": ("tf", "tree"),
    "tf_echo": _TF_ECHO,
    "tf_monitor": ("tf", "tree"),
    "turtlesim": "lcmtools run sim starts a simulated robot, lcmtools lab list shows the labs",
    "view_frames": ("tf", "tree"),
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
    "pkg create --build-type": "--cpp creates one in C++; for one in Python, leave it out",
    "pkg create --node-name": "--node names the node",
    "launch -p": "LCM has no master; --lcm-url and --domain choose the bus",
    "launch --required": "required is a key of a node in the file",
    "run --prefix": "put it in front: gdb --args lcmtools run NODE",
}
"""Hints for the options of ROS: of every command, or of one."""
PREFIXES = ("ament", "catkin", "colcon", "gz", "ros", "rqt", "rviz", "tf2_")
"""The beginnings of programs' names."""
NOT_MESSAGES = ("roscpp", "rospy", "rclcpp", "rclpy", "message_generation", "message_runtime")
"""Dependencies that have no messages."""
LANGUAGES: Mapping[str, str] = {
    **dict.fromkeys(("roscpp", "rclcpp", "ament_cmake"), "C++"),
    **dict.fromkeys(("rospy", "rclpy", "ament_python", "ament_cmake_python"), "Python"),
}
"""Dependencies and build types that tell a package's language."""
PACKAGE_OPTIONS: Mapping[str, str] = {
    **dict.fromkeys(("--license", "-l"), "--license"),
    "--node-name": "--node",
    "--destination-directory": "DIR",
    **dict.fromkeys(("--author", "-a", "--maintainer", "-m", "--meta", "--rosdistro"), ""),
    **dict.fromkeys(("--description", "-D", "--pkg_version", "-V", "--build-type"), ""),
    **dict.fromkeys(("--package-format", "--library-name", "--maintainer-email"), ""),
    "--maintainer-name": "",
}
"""Options with a value, of catkin_create_pkg and ros2 pkg create: lcmtools' own, or "" for none."""
