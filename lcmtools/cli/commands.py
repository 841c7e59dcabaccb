"""The tables of commands: name, home and help line of each; a command's module is not imported."""

from lcmtools.cli.lazy import Entry

_TOPIC = "lcmtools.cli.topic"
TOPIC_COMMANDS = {
    "list": Entry(f"{_TOPIC}.list:command", "List the topics on the bus."),
    "info": Entry(f"{_TOPIC}.info:command", "Show a topic's type, publishers and subscribers."),
    "echo": Entry(f"{_TOPIC}.echo:command", "Print the messages of a topic."),
    "pub": Entry(f"{_TOPIC}.pub:command", "Publish messages written in YAML."),
    "hz": Entry(f"{_TOPIC}.rates:hz", "Measure the rate of topics."),
    "bw": Entry(f"{_TOPIC}.rates:bw", "Measure the bandwidth of topics."),
    "delay": Entry(f"{_TOPIC}.rates:delay", "Measure the delay of a topic's messages."),
    "type": Entry(f"{_TOPIC}.types:print_type", "Print a topic's type."),
    "find": Entry(f"{_TOPIC}.types:find", "List the topics of a type."),
}
NODE_COMMANDS = {
    "list": Entry("lcmtools.cli.node.list:list_nodes", "List the nodes on the bus."),
    "info": Entry("lcmtools.cli.node.info:command", "Show a node's publications and more."),
    "machine": Entry("lcmtools.cli.node.list:machine", "List the computers that nodes run on."),
    "ping": Entry("lcmtools.cli.node.ping:command", "Measure a node's response time."),
    "kill": Entry("lcmtools.cli.node.kill:command", "Ask nodes to shut down."),
    "cleanup": Entry("lcmtools.cli.node.list:cleanup", "Forget nodes that were killed."),
}
_MSG = "lcmtools.cli.msg"
MSG_COMMANDS = {
    "list": Entry(f"{_MSG}.look:list_types", "List the message types."),
    "show": Entry(f"{_MSG}.look:show_type", "Show the fields of a message type."),
    "proto": Entry(f"{_MSG}.look:proto", "Print a message to fill in, for pub."),
    "find-field": Entry(f"{_MSG}.look:find_field", "Find types by a field's name."),
    "package": Entry(f"{_MSG}.look:package_command", "List the message types of a package."),
    "packages": Entry(f"{_MSG}.look:packages_command", "List the packages."),
    "fingerprint": Entry(f"{_MSG}.look:print_fingerprint", "Print a type's fingerprint."),
    "build": Entry(f"{_MSG}.build:build", "Check and compile your own .lcm files."),
    "generate": Entry(f"{_MSG}.build:generate_code", "Write C, C++, Java or Python code."),
    "info": Entry(f"{_MSG}.look:show_type", "show, as ROS.", is_alias=True),
    "md5": Entry(f"{_MSG}.look:print_fingerprint", "fingerprint, as ROS.", is_alias=True),
}
_PKG = "lcmtools.cli.pkg"
PKG_COMMANDS = {
    "create": Entry(f"{_PKG}.create:command", "Create a package: a node, a test and more."),
    "list": Entry(f"{_PKG}.look:list_packages", "List the packages and their folders."),
    "find": Entry(f"{_PKG}.look:find_command", "Print a package's folder."),
    "build": Entry(f"{_PKG}.look:build", "Check and compile packages' messages."),
    "prefix": Entry(f"{_PKG}.look:find_command", "find, as ROS 2 names it.", is_alias=True),
}
SRV_COMMANDS = {
    "list": Entry(f"{_MSG}.look:list_services", "List the service types."),
    "show": Entry(f"{_MSG}.look:show_service", "Show the fields of a service type."),
}
_SERVICE = "lcmtools.cli.service"
SERVICE_COMMANDS = {
    "list": Entry(f"{_SERVICE}.look:list_services", "List the services of nodes."),
    "info": Entry(f"{_SERVICE}.look:info", "Show a service's node, type and arguments."),
    "call": Entry(f"{_SERVICE}.call:command", "Call a service and print its response."),
    "type": Entry(f"{_SERVICE}.look:type_", "Print a service's type."),
    "find": Entry(f"{_SERVICE}.look:find", "List the services of a type."),
    "args": Entry(f"{_SERVICE}.look:args", "Print a service's arguments."),
}
_PARAM = "lcmtools.cli.param"
PARAM_COMMANDS = {
    "list": Entry(f"{_PARAM}.read:list_parameters", "List the parameters of nodes."),
    "get": Entry(f"{_PARAM}.read:get", "Print a parameter, or all of a node's."),
    "set": Entry(f"{_PARAM}.write:set_parameters", "Set parameters of a node."),
    "describe": Entry(f"{_PARAM}.read:describe", "Show a parameter's description and range."),
    "dump": Entry(f"{_PARAM}.read:dump", "Write parameters into a YAML file."),
    "load": Entry(f"{_PARAM}.write:load", "Set parameters from a YAML file."),
}
PARAM_ABSENT = {
    "delete": "a node has its parameters for as long as it runs; param set gives one another value"
}
_SIM = "lcmtools.cli.sim"
SIM_COMMANDS = {
    "pause": Entry(f"{_SIM}.time:pause", "Pause simulated time."),
    "resume": Entry(f"{_SIM}.time:resume", "Resume simulated time."),
    "step": Entry(f"{_SIM}.time:step", "Advance a paused simulator by some steps."),
    "reset": Entry(f"{_SIM}.time:reset", "Start again at time 0."),
    "set-rate": Entry(f"{_SIM}.time:set_rate", "Set the rate of simulated time."),
    "state": Entry(f"{_SIM}.robots:state", "Show the true state of a robot."),
    "set-pose": Entry(f"{_SIM}.robots:set_pose", "Place a robot at a pose."),
    "spawn": Entry(f"{_SIM}.robots:spawn", "Add a robot."),
    "delete": Entry(f"{_SIM}.robots:delete", "Remove a robot."),
    "snapshot": Entry(f"{_SIM}.snapshot:command", "Write an image of the world to a file."),
}
_LAB = "lcmtools.labs.commands"
LAB_COMMANDS = {
    "list": Entry(f"{_LAB}.list:command", "List the labs."),
    "start": Entry(f"{_LAB}.start:command", "Run a lab's simulator."),
    "check": Entry(f"{_LAB}.check:command", "Check the programs of a lab."),
    "skeleton": Entry(f"{_LAB}.skeleton:command", "Copy a lab's node to complete."),
}
COMMANDS = {
    **TOPIC_COMMANDS,
    "spy": Entry("lcmtools.cli.spy.command:command", "Watch all channels of the bus, live."),
    "node": Entry("lcmtools.cli.main:node", "Query nodes: list, info, ping and more."),
    "msg": Entry("lcmtools.cli.main:msg", "Show message types: list, show, proto and more."),
    "service": Entry("lcmtools.cli.main:service", "List and call services."),
    "param": Entry("lcmtools.cli.main:param", "Read and set parameters of nodes."),
    "srv": Entry("lcmtools.cli.main:srv", "Show service types: list, show."),
    "graph": Entry("lcmtools.cli.graph.command:command", "Draw the graph of nodes and topics."),
    "wtf": Entry("lcmtools.cli.wtf:command", "Report faults and how to fix them."),
    "sim": Entry("lcmtools.cli.main:sim", "Control a simulator: pause, reset, set-pose and more."),
    "run": Entry("lcmtools.cli.run:command", "Run a node, or the simulator."),
    "lab": Entry("lcmtools.cli.main:lab", "Work on the labs: list, start, check and more."),
    "launch": Entry("lcmtools.cli.launch.command:command", "Run the nodes of a launch file."),
    "pkg": Entry("lcmtools.cli.main:pkg", "Create and find packages: create, list, build."),
    "config": Entry("lcmtools.cli.config:command", "Show the settings and their sources."),
    "completion": Entry("lcmtools.cli.completion.command:command", "Complete words with TAB."),
    "help": Entry("lcmtools.cli.help:command", "Show the help of a command."),
    "topic": Entry("lcmtools.cli.main:topic", "topic list is list, and so on.", is_alias=True),
    "doctor": Entry("lcmtools.cli.wtf:command", "wtf, as ROS 2 names it.", is_alias=True),
    "interface": Entry("lcmtools.cli.main:msg", "msg, as ROS 2 names it.", is_alias=True),
}
