"""The commands: name, home and help line of each; a command's module is not imported."""

from collections.abc import Mapping

from lcmtools.cli.declare import CONTEXT, with_examples
from lcmtools.cli.lazy import Entry, LazyGroup
from lcmtools.cli.options import bus_options


def _group(
    name: str,
    text: str,
    entries: Mapping[str, Entry],
    *examples: str,
    has_bus: bool = True,
) -> LazyGroup:
    """A group of commands; where it has a bus, that may be named before the command."""
    text = with_examples(text, (f"{name} {example}" for example in examples))
    group = LazyGroup(name, entries=entries, help=text, context_settings=CONTEXT)
    return bus_options(group) if has_bus else group


_TOPIC = {
    "list": Entry("cli.topic.list:command", "List the topics on the bus."),
    "info": Entry("cli.topic.info:command", "Show a topic's type, publishers and subscribers."),
    "echo": Entry("cli.topic.echo:command", "Print the messages of a topic."),
    "pub": Entry("cli.topic.pub:command", "Publish messages written in YAML."),
    "hz": Entry("cli.topic.rates:hz", "Measure the rate of topics."),
    "bw": Entry("cli.topic.rates:bw", "Measure the bandwidth of topics."),
    "delay": Entry("cli.topic.rates:delay", "Measure the delay of a topic's messages."),
    "type": Entry("cli.topic.types:print_type", "Print a topic's type."),
    "find": Entry("cli.topic.types:find", "List the topics of a type."),
}
topic = _group("topic", "Look at topics and publish on them.", _TOPIC, "list", "echo /chatter")
_NODE = {
    "list": Entry("cli.node.list:list_nodes", "List the nodes on the bus."),
    "info": Entry("cli.node.info:command", "Show a node's publications and more."),
    "machine": Entry("cli.node.list:machine", "List the computers that nodes run on."),
    "ping": Entry("cli.node.ping:command", "Measure a node's response time."),
    "kill": Entry("cli.node.kill:command", "Ask nodes to shut down."),
    "cleanup": Entry("cli.node.list:cleanup", "Forget nodes that were killed."),
}
node = _group("node", "Query nodes, and end them.", _NODE, "list", "info simple_controller")
_MSG = {
    "list": Entry("cli.msg.look:list_types", "List the message types."),
    "show": Entry("cli.msg.look:show_type", "Show the fields of a message type."),
    "proto": Entry("cli.msg.look:proto", "Print a message to fill in, for pub."),
    "find-field": Entry("cli.msg.look:find_field", "Find types by a field's name."),
    "package": Entry("cli.msg.look:package_command", "List the message types of a package."),
    "packages": Entry("cli.msg.look:packages_command", "List the packages."),
    "fingerprint": Entry("cli.msg.look:print_fingerprint", "Print a type's fingerprint."),
    "build": Entry("cli.msg.build:build", "Check and compile your own .lcm files."),
    "generate": Entry("cli.msg.build:generate_code", "Write C, C++, Java or Python code."),
    "info": Entry("cli.msg.look:show_type", "show, as ROS.", is_alias=True),
    "md5": Entry("cli.msg.look:print_fingerprint", "fingerprint, as ROS.", is_alias=True),
}
msg = _group("msg", "Show message types.", _MSG, "list", "show geometry_msgs/Twist", has_bus=False)
_PKG = {
    "create": Entry("cli.pkg.create:command", "Create a package: a node, a test and more."),
    "add-node": Entry("labs.commands.add_node:command", "Add a node to a package."),
    "list": Entry("cli.pkg.look:list_packages", "List the packages and their folders."),
    "find": Entry("cli.pkg.look:find_command", "Print a package's folder."),
    "build": Entry("cli.pkg.look:build", "Check and compile packages' messages."),
    "prefix": Entry("cli.pkg.look:find_command", "find, as ROS 2 names it.", is_alias=True),
}
pkg = _group(
    "pkg",
    "Create and find packages of nodes and messages.",
    _PKG,
    "create air_lab0 --deps nav_msgs geometry_msgs",
    "list",
    has_bus=False,
)
_SRV = {
    "list": Entry("cli.msg.look:list_services", "List the service types."),
    "show": Entry("cli.msg.look:show_service", "Show the fields of a service type."),
}
srv = _group("srv", "Show service types.", _SRV, "list", "show std_srvs/Trigger", has_bus=False)
_SERVICE = {
    "list": Entry("cli.service.look:list_services", "List the services of nodes."),
    "info": Entry("cli.service.look:info", "Show a service's node, type and arguments."),
    "call": Entry("cli.service.call:command", "Call a service and print its response."),
    "type": Entry("cli.service.look:type_", "Print a service's type."),
    "find": Entry("cli.service.look:find", "List the services of a type."),
    "args": Entry("cli.service.look:args", "Print a service's arguments."),
}
service = _group(
    "service", "List and call services.", _SERVICE, "list", 'call /switch "data: true"'
)
_PARAM = {
    "list": Entry("cli.param.read:list_parameters", "List the parameters of nodes."),
    "get": Entry("cli.param.read:get", "Print a parameter, or all of a node's."),
    "set": Entry("cli.param.set:set_parameters", "Set parameters of a node."),
    "describe": Entry("cli.param.read:describe", "Show a parameter's description and range."),
    "dump": Entry("cli.param.files:dump", "Write parameters into a YAML file."),
    "load": Entry("cli.param.files:load", "Set parameters from a YAML file."),
}
param = _group(
    "param",
    "Read and set the parameters of running nodes.",
    _PARAM,
    "list",
    "set simple_controller kp 0.5",
)
_SIM = {
    "pause": Entry("cli.sim.time:pause", "Pause simulated time."),
    "resume": Entry("cli.sim.time:resume", "Resume simulated time."),
    "step": Entry("cli.sim.time:step", "Advance a paused simulator by some steps."),
    "reset": Entry("cli.sim.time:reset", "Start again at time 0."),
    "set-rate": Entry("cli.sim.time:set_rate", "Set the rate of simulated time."),
    "state": Entry("cli.sim.robots:state", "Show the true state of a robot."),
    "set-pose": Entry("cli.sim.robots:set_pose", "Place a robot at a pose."),
    "spawn": Entry("cli.sim.robots:spawn", "Add a robot."),
    "delete": Entry("cli.sim.robots:delete", "Remove a robot."),
    "snapshot": Entry("cli.sim.snapshot:command", "Write an image of the world to a file."),
}
sim = _group(
    "sim",
    "Control a simulator on the bus; lcmtools run sim starts one.",
    _SIM,
    "pause",
    "set-pose husky0 1 -2 90deg",
)
_LAB = {
    "list": Entry("labs.commands.lab:list_labs", "List the labs."),
    "start": Entry("labs.commands.lab:start", "Run a lab's simulator."),
    "check": Entry("labs.commands.check:command", "Check the programs of a lab."),
    "skeleton": Entry("labs.commands.lab:skeleton", "Copy a lab's node to complete."),
}
lab = _group(
    "lab",
    "Work on the labs: start their simulators, and check your programs.",
    _LAB,
    "start husky",
    'check husky --controller "python my_controller.py"',
)
COMMANDS = {
    **_TOPIC,
    "spy": Entry("cli.spy.command:command", "Watch all channels of the bus, live."),
    "node": Entry("cli.commands:node", "Query nodes: list, info, ping and more."),
    "msg": Entry("cli.commands:msg", "Show message types: list, show, proto and more."),
    "service": Entry("cli.commands:service", "List and call services."),
    "param": Entry("cli.commands:param", "Read and set parameters of nodes."),
    "srv": Entry("cli.commands:srv", "Show service types: list, show."),
    "graph": Entry("cli.graph.command:command", "Draw the graph of nodes and topics."),
    "wtf": Entry("cli.wtf:command", "Report faults and how to fix them."),
    "sim": Entry("cli.commands:sim", "Control a simulator: pause, reset, set-pose and more."),
    "run": Entry("cli.run:command", "Run a node, or the simulator."),
    "lab": Entry("cli.commands:lab", "Work on the labs: list, start, check and more."),
    "launch": Entry("cli.launch.command:command", "Run the nodes of a launch file."),
    "pkg": Entry("cli.commands:pkg", "Create and find packages: create, list, build."),
    "config": Entry("cli.config:command", "Show the settings and their sources."),
    "completion": Entry("cli.completion.command:command", "Complete words with TAB."),
    "help": Entry("cli.help:command", "Show the help of a command."),
    "topic": Entry("cli.commands:topic", "topic list is list, and so on.", is_alias=True),
    "doctor": Entry("cli.wtf:command", "wtf, as ROS 2 names it.", is_alias=True),
    "interface": Entry("cli.commands:msg", "msg, as ROS 2 names it.", is_alias=True),
}
