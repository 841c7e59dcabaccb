"""Tables of the commands: name, module and help line. The modules are not imported."""

from collections.abc import Mapping

from lcmtools.cli.declare import CONTEXT, with_examples
from lcmtools.cli.lazy import Entry, LazyGroup, WindowGroup
from lcmtools.cli.options import bus_options


def _group(
    name: str, text: str, entries: Mapping[str, Entry], *examples: str, has_bus: bool = True
) -> LazyGroup:
    """Return a group of commands. With ``has_bus``, the bus options may precede the command."""
    text = with_examples(text, (f"{name} {example}" for example in examples))
    group = LazyGroup(name, entries=entries, help=text, context_settings=CONTEXT)
    return bus_options(group) if has_bus else group


def _entries(table: str) -> Mapping[str, Entry]:
    """Read a table of names, modules and help lines; "=" marks the help line of an alias."""
    rows = (line.split(None, 2) for line in table.splitlines())
    return {name: Entry(home, text.removeprefix("= "), text[0] == "=") for name, home, text in rows}


TOPIC_VERBS = _entries("""\
list   cli.topic.list:command          List the topics on the bus.
info   cli.topic.info:command          Show a topic's type, publishers and subscribers.
echo   cli.topic.echo:command          Print the messages of a topic.
pub    cli.topic.pub:command           Publish messages written in YAML.
hz     cli.topic.hz_bw_delay:hz        Measure the rate of topics.
bw     cli.topic.hz_bw_delay:bw        Measure the bandwidth of topics.
delay  cli.topic.hz_bw_delay:delay     Measure the delay of a topic's messages.
type   cli.topic.info:print_type       Print a topic's type.
find   cli.topic.info:find             List the topics of a type.
""")
topic = _group("topic", "Look at topics and publish on them.", TOPIC_VERBS, "list", "echo /chatter")
_NODE = _entries("""\
list     cli.node.list:list_nodes  List the nodes on the bus.
info     cli.node.info:command     Show a node's publications and more.
machine  cli.node.list:machine     List the computers that nodes run on.
ping     cli.node.ping:command     Measure a node's response time.
kill     cli.node.kill:command     Ask nodes to shut down.
cleanup  cli.node.list:cleanup     Forget nodes that were killed.
""")
node = _group("node", "Query nodes, and end them.", _NODE, "list", "info simple_controller")
_MSG = _entries("""\
list         cli.msg:list_types           List the message types.
show         cli.msg:show_type            Show the fields of a message type.
proto        cli.msg:proto                Print a message to fill in, for pub.
find-field   cli.msg:find_field           Find types by a field's name.
package      cli.msg:package_command      List the message types of a package.
packages     cli.msg:packages_command     List the packages.
fingerprint  cli.msg:print_fingerprint    Print a type's fingerprint.
build        cli.msg_build:build          Check and compile your own .lcm files.
generate     cli.msg_build:generate_code  Write C, C++, Java or Python code.
info         cli.msg:show_type            = show, as ROS.
md5          cli.msg:print_fingerprint    = fingerprint, as ROS.
""")
msg = _group("msg", "Show message types.", _MSG, "list", "show geometry_msgs/Twist", has_bus=False)
_PKG = _entries("""\
create    cli.pkg:create_package          Create a package: a node, a test and more.
add-node  labs.commands.add_node:command  Add a node to a package.
list      cli.pkg:list_packages           List the packages and their folders.
find      cli.pkg:find_command            Print a package's folder.
build     cli.pkg:build                   Compile packages' messages and C++ nodes.
prefix    cli.pkg:find_command            = find, as ROS 2 names it.
cpp-path  cli.pkg:cpp_path                Print the folder of the C++ headers.
""")
pkg = _group(
    "pkg",
    "Create and find packages of nodes and messages.",
    _PKG,
    "create air_lab0 --deps nav_msgs geometry_msgs",
    "list",
    has_bus=False,
)
_SRV = _entries("""\
list  cli.msg:list_services  List the service types.
show  cli.msg:show_service   Show the fields of a service type.
info  cli.msg:show_service   = show, as ROS.
""")
srv = _group("srv", "Show service types.", _SRV, "list", "show std_srvs/Trigger", has_bus=False)
_SERVICE = _entries("""\
list  cli.service.look:list_services  List the services of nodes.
info  cli.service.look:info           Show a service's node, type and arguments.
call  cli.service.call:command        Call a service and print its response.
type  cli.service.look:type_          Print a service's type.
find  cli.service.look:find           List the services of a type.
args  cli.service.look:args           Print a service's arguments.
""")
service = _group(
    "service", "List and call services.", _SERVICE, "list", 'call /switch "data: true"'
)
_PARAM = _entries("""\
list      cli.param:list_parameters  List the parameters of nodes.
get       cli.param:get              Print a parameter, or all of a node's.
set       cli.param:set_parameters   Set parameters of a node.
describe  cli.param:describe         Show a parameter's description and range.
dump      cli.param:dump             Write parameters into a YAML file.
load      cli.param:load             Set parameters from a YAML file.
""")
param = _group(
    "param",
    "Read and set the parameters of running nodes.",
    _PARAM,
    "list",
    "set simple_controller kp 0.5",
)
_BAG = _entries("""\
record      cli.bag.record:command         Record messages into a log.
play        cli.bag.play:command           Publish the messages of logs again, as timed.
rerun       cli.bag.rerun:command          Test a program with a recording.
info        cli.bag.info:info              Show what is in logs.
plot        cli.plot:of_log                Draw fields of a log over time.
filter      cli.bag.edit:filter_           Write the messages that meet a condition.
cut         cli.bag.edit:cut               Write the part between two times.
merge       cli.bag.edit:merge             Merge logs into one.
sort        cli.bag.edit:sort              Sort messages by time.
rename      cli.bag.edit:rename            Rename topics.
shift       cli.bag.edit:shift             Change the recorded times.
downsample  cli.bag.edit:downsample        Reduce the rate of topics.
check       cli.bag.check_diff_du:check    Check a log against a contract.
diff        cli.bag.check_diff_du:diff     Compare two logs.
du          cli.bag.check_diff_du:du       Show which topics take the most space.
fix         cli.bag.edit:fix               Recover what can be read from a damaged log.
reindex     cli.bag.info:reindex           Write the index of a log.
export      cli.bag.export_import:export_  Write a log as CSV, JSON, NumPy, Parquet, MCAP, ROS bag.
import      cli.bag.export_import:import_  Convert a ROS bag or an MCAP file to a log.
""")
bag = _group(
    "bag",
    "Record messages; inspect, play, edit and convert logs.",
    _BAG,
    "record -o ride.lcmlog",
    "play ride.lcmlog",
    "info ride.lcmlog",
    "plot ride.lcmlog /husky0/odometry/twist.twist.linear.x",
    "cut ride.lcmlog end.lcmlog -s end-1m",
    "plot ride.lcmlog /imu/angular_velocity -o turning.png",
)
_TF = _entries("""\
tree  cli.tf:tree  Show the tree of coordinate frames.
echo  cli.tf:echo  Print the pose of a frame in another one.
""")
tf = _group("tf", "Look at coordinate frames.", _TF, "tree", "echo odom base_link")
_GUI = _entries("""\
all         cli.gui.panels:all_panels  Open a window with all panels; the default.
steer       cli.gui.panels:steer       Steer a robot by joystick, keys or gamepad.
plot        cli.gui.panels:plot        Plot fields of messages over time.
image       cli.gui.panels:image       Show the images of a topic: colour, grey and depth.
graph       cli.gui.panels:graph       Show nodes and topics, and what is wrong with them.
world       cli.gui.panels:world       Show robots, sensors and paths in 3D.
topics      cli.gui.panels:topics      Show the topics, decode messages, publish.
log         cli.gui.panels:log         Show the nodes' log lines.
services    cli.gui.panels:services    Call services.
parameters  cli.gui.panels:parameters  Show and set the parameters of nodes.
record      cli.gui.panels:record      Start and stop a recording.
""")
gui = WindowGroup(
    "gui",
    entries=_GUI,
    help=with_examples(
        "Open a window in the browser: topics, plots, images, the robot.", ["gui", "gui topics"]
    ),
    context_settings=CONTEXT,
)
_SIM = _entries("""\
pause     cli.sim:pause     Pause simulated time.
resume    cli.sim:resume    Resume simulated time.
step      cli.sim:step      Advance a paused simulator by some steps.
reset     cli.sim:reset     Start again at time 0.
set-rate  cli.sim:set_rate  Set the rate of simulated time.
state     cli.sim:state     Show the true state of a robot.
set-pose  cli.sim:set_pose  Place a robot at a pose.
spawn     cli.sim:spawn     Add a robot.
delete    cli.sim:delete    Remove a robot.
snapshot  cli.sim:snapshot  Write an image of the world to a file.
""")
sim = _group(
    "sim",
    "Control a simulator on the bus; lcmtools run sim starts one.",
    _SIM,
    "pause",
    "set-pose husky0 1 -2 90deg",
)
_LAB = _entries("""\
list      labs.commands.lab:list_labs  List the labs.
start     labs.commands.lab:start      Run a lab's simulator.
check     labs.commands.lab:check      Check the programs of a lab.
skeleton  labs.commands.lab:skeleton   Copy a lab's node to complete.
""")
lab = _group(
    "lab",
    "Work on the labs: start their simulators, and check your programs.",
    _LAB,
    "start husky",
    'check husky --controller "python my_controller.py"',
)
COMMANDS = {
    **TOPIC_VERBS,
    **_entries("""\
spy         cli.spy.spy:command                Watch all channels of the bus, live.
plot        cli.plot:command                   Draw fields of messages over time, live.
bag         cli.commands:bag                   Record, play and inspect logs.
relay       cli.relay:command                  Carry messages between buses; serve tcpq.
foxglove    cli.foxglove:command               Serve the bus to Foxglove and Lichtblick.
tf          cli.commands:tf                    Show coordinate frames: tree, echo.
node        cli.commands:node                  Query nodes: list, info, ping and more.
msg         cli.commands:msg                   Show message types: list, show, proto and more.
service     cli.commands:service               List and call services.
param       cli.commands:param                 Read and set parameters of nodes.
srv         cli.commands:srv                   Show service types: list, show.
gui         cli.commands:gui                   Open a window in the browser: topics and more.
graph       cli.graph:command                  Draw the graph of nodes and topics.
wtf         cli.wtf:command                    Report faults and how to fix them.
sim         cli.commands:sim                   Control a simulator: pause, reset, set-pose and more.
run         cli.run:command                    Run a node, or the simulator.
lab         cli.commands:lab                   Work on the labs: list, start, check and more.
launch      cli.launch:command                 Run the nodes of a launch file.
pkg         cli.commands:pkg                   Create and find packages: create, list, build.
config      cli.config:command                 Show the settings and their sources.
completion  cli.completion.completion:command  Complete words with TAB.
help        cli.help:command                   Show the help of a command.
topic       cli.commands:topic                 = topic list is list, and so on.
doctor      cli.wtf:command                    = wtf, as ROS 2 names it.
interface   cli.commands:msg                   = msg, as ROS 2 names it.
"""),
}
