"""Rules about nodes, and what they report: exceptions of callbacks, and logs."""

from collections import defaultdict
from collections.abc import Iterator

from lcmtools.bus.url import another_domain
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import (
    Finding,
    Part,
    Severity,
    Statement,
    Subject,
    finding,
    rule,
    state,
)
from lcmtools.doctor.renaming import DROP_REMAP
from lcmtools.doctor.rules.shared import WAKE_OR_END
from lcmtools.graph.model import VERSION, NodeInfo, Staleness
from lcmtools.graph.protocol import SOFTWARE
from lcmtools.observe.simulators import publishes_time

_SELECT = 1024  # liblcm's binding waits with select(2)
_MOST_FILES = 0.9


@rule(
    "stale-nodes",
    remedy="wake it: kill -CONT PID; or forget it: lcmtools node cleanup",
    severity=Severity.ERROR,
    title="The following nodes do not answer any more:",
    facts={
        "may-be-late": "this computer is too busy to tell: they may only be late",
        "stale": "{node} (pid {pid}): {why}",
        "stale-elsewhere": "{node} (pid {pid} on {host:at}): {why}",
    },
    remedies={
        **WAKE_OR_END,
        "look-there": "check there whether the network and the node work: `lcmtools wtf`",
        "restart-or-forget": "start {node} again, or forget it: `lcmtools node cleanup`",
    },
    evidence="announcements, the records of nodes of this computer",
)
def nodes_answer(evidence: Evidence) -> Iterator[Finding]:
    """Every node that was seen before and did not say goodbye still answers.

    A node that does not was killed, is stopped, or its computer is gone. A note if this computer is
    so busy that the answer may only be late.
    """
    alive = {node.name for node in evidence.graph.nodes if not node.stale}
    # a command that was killed is no part of the system
    stale = [node for node in evidence.graph.nodes if node.stale and not node.is_hidden]
    stale = [node for node in stale if _runs(node) or node.name not in alive]  # not started again
    published, subscribed = evidence.stale_published, evidence.stale_subscribed
    title = state("stale-nodes").of("published", *published).of("subscribed", *subscribed)
    for severity in (Severity.ERROR, Severity.NOTE):
        is_sure = severity is Severity.ERROR
        pairs = [_stale(evidence, one) for one in stale if _is_sure(evidence, one) is is_sure]
        facts = [fact for fact, _ in pairs]
        facts += [state("may-be-late")] if facts and not is_sure else []
        yield from finding(title, facts, *(x for _, x in pairs), severity=severity)


def _is_sure(evidence: Evidence, node: NodeInfo) -> bool:
    """Return whether the answer of a node would have been received."""
    stopped = {one.pid for one in evidence.listeners if one.state == "T"}
    stopped |= {one.pid for one in evidence.processes if one.state == "T"}
    is_deaf = evidence.own_drops > sum(sender.messages for sender in evidence.senders)
    is_known = node.stale is Staleness.ENDED or node.pid in stopped
    return is_known or not (is_deaf or evidence.wait_share())


def _stale(evidence: Evidence, node: NodeInfo) -> tuple[Statement, Statement]:
    """Return the fact and the remedy; a process number is valid only on its own computer."""
    pid, why = node.pid, str(node.stale)
    if node.id in evidence.remote:
        host = Subject("host", node.host, address=node.sender.address if node.sender else "")
        fact = state("stale-elsewhere", node=node, host=host, pid=pid, why=why)
        return fact, state("look-there", host=node.host)
    fact = state("stale", node=node, pid=pid, why=why)
    wake, forget = state("wake-or-end", pid=pid), state("restart-or-forget", node=node)
    return fact, wake if _runs(node) else forget


def _runs(node: NodeInfo) -> bool:
    return node.stale is not Staleness.ENDED


@rule(
    "duplicate-names",
    remedy="start one of them with __name:=ANOTHER",
    severity=Severity.ERROR,
    title="{count} nodes have the name {name}:",
    facts={"node-process": "pid {pid} on {host}: {command}"},
    remedies={
        "end-or-part": "end one of them{pids:kills}, or start it on another bus, with --domain"
        " {domain}",
        "end-or-rename": "end one of them{pids:kills}, or start it with __name:={name}",
    },
    evidence="announcements",
)
def nodes_have_names_of_their_own(evidence: Evidence) -> Iterator[Finding]:
    """No two nodes have the same name.

    Often an old process was left over. Commands that take a node's name cannot tell them apart. A
    second simulator needs a bus of its own, because it publishes /clock, too.
    """
    by_name: dict[str, list[NodeInfo]] = defaultdict(list)
    for node in evidence.graph.nodes:
        if not (node.stale or node.tool):  # a command that observes and publishes is two
            by_name[node.name].append(node)
    for name, nodes in by_name.items():
        if len(nodes) > 1:
            facts = (
                state("node-process", node=x, pid=x.pid, host=x.host, command=x.command)
                for x in nodes
            )
            title = state("duplicate-names", count=len(nodes), name=name)
            pids = tuple(str(one.pid) for one in nodes if one.id not in evidence.remote)
            kills = pids if len(pids) > 1 else ()
            remedy = state("end-or-rename", pids=kills, name=f"{name.rpartition('/')[2]}2")
            if sum(map(publishes_time, nodes)) > 1:
                remedy = state("end-or-part", pids=kills, domain=another_domain(evidence.url))
            yield from finding(title, facts, remedy)


@rule(
    "no-clock",
    remedy="start the simulator, or the node without _use_sim_time:=true",
    severity=Severity.ERROR,
    title="The following nodes use simulated time, and nothing publishes {topic}:",
    facts={"node-pid": "{node} (pid {pid})"},
    remedies={
        **DROP_REMAP,
        "start-simulator": "or start the simulator, for example: `lcmtools run sim`",
    },
    unless={"stale-nodes": "published"},
    evidence="announcements",
)
def simulated_time_has_a_source(evidence: Evidence) -> Iterator[Finding]:
    """Simulated time has a publisher, if any node uses it.

    For a node with _use_sim_time:=true, time does not pass until a message comes on /clock: its
    timers never run.
    """
    topic = evidence.graph.topic(CLOCK_TOPIC)
    waiting = [node for node, _ in topic.subscribers if not (node.stale or node.tool)]
    sources = [node for node, _ in topic.publishers if not node.stale]
    if not (sources or topic.foreign):
        facts = (state("node-pid", node=node, pid=node.pid) for node in waiting)
        argument = "_use_sim_time:=true"
        remedies = (state("drop-remap", node=node, argument=argument) for node in waiting)
        title = state("no-clock", topic=CLOCK_TOPIC)
        yield from finding(title, facts, *remedies, "start-simulator")


@rule(
    "open-files",
    remedy="close files and sockets that are not needed",
    title="The following programs have nearly as many files open as LCM can handle:",
    facts={
        "open-files": "pid {process.pid} has {open_files} files open, of {most_files}: {process}",
    },
    remedies={
        "close-files": "close unneeded files, or restart the programs; a limit above 1024 does not"
        " help, because liblcm waits with select",
    },
    evidence="the open files of your programs",
    root_only="other users' programs",
)
def files_are_few(evidence: Evidence) -> Iterator[Finding]:
    """No program has nearly as many files open as it may.

    liblcm waits with select, and crashes with a file descriptor of 1024 or more, however high the
    limit of the process is.
    """
    limits = [(p, min(p.most_files or _SELECT, _SELECT)) for p in evidence.processes if not p.bus]
    near = ((p, p.open_files, most) for p, most in limits if p.open_files > _MOST_FILES * most)
    facts = (state("open-files", process=p, open_files=n, most_files=most) for p, n, most in near)
    return finding("open-files", facts, "close-files")


@rule(
    "other-version",
    remedy="update lcmtools where the older program runs",
    severity=Severity.NOTE,
    title="The following nodes speak another version of the protocol than this program ({own}):",
    facts={
        "speaks": "{node} (pid {pid} on {host}): version {version}{software:brackets}",
        "speaks-unread": (
            "{node} (pid {pid} on {host}): version {version}{software:brackets}, of which only"
            " name and process can be read, and the topics that it is seen to publish on"
        ),
    },
    remedies={
        "update-there": "update lcmtools where {nodes:list} {nodes:run}",
        "update-here": "update the lcmtools that wtf was started from: here it is {software}",
    },
    evidence="announcements",
)
def nodes_speak_the_same_version(evidence: Evidence) -> Iterator[Finding]:
    """All nodes announce themselves by the same version of the protocol as this program.

    Nodes of other versions work together, but may not tell everything of each other.
    """
    seen = [node for node in evidence.graph.nodes if not (node.stale or node.is_hidden)]
    others = [node for node in seen if node.version != VERSION or not node.has_details]
    kinds = ((x, "speaks" if x.has_details else "speaks-unread") for x in others)
    facts = [
        state(kind, node=x, pid=x.pid, host=x.host, version=x.version, software=x.software)
        for x, kind in kinds
    ]
    older = tuple(dict.fromkeys(node.name for node in others if node.version < VERSION))
    remedies = [state("update-there", nodes=older)] if older else []
    if any(node.version > VERSION for node in others):
        remedies.append(state("update-here", software=SOFTWARE))
    title = state("other-version", own=VERSION)
    yield from finding(title, facts, *remedies)


_RECENT = 10.0  # [s]
_IGNORED = ": message ignored: "  # as nodes log it, after the topic
_RAISED = ("exception", "count", "place", "message", "callback")


@rule(
    "callback-errors",
    remedy="correct the line that is named, and start the node again",
    severity=Severity.ERROR,
    title="Callbacks of the following raise exceptions:",
    facts={
        "raised": "{node} raised {exception} {count:times}, {place}: {message} (in {callback:call})"
    },
    remedies={"correct": "correct {place}, and start {node} again"},
    evidence="the exceptions that nodes announce",
)
def callbacks_do_not_raise(evidence: Evidence) -> Iterator[Finding]:
    """Callbacks raise no exceptions.

    A node continues after an exception, but skips the rest of the callback, such as its answer to a
    message. A warning if the last one was some time ago.
    """
    nodes = [node for node in evidence.graph.nodes if not (node.tool or node.stale)]
    pairs = [(node, error) for node in nodes for error in node.errors]
    for severity in (Severity.ERROR, Severity.WARNING):
        facts, remedies = [], []
        for node, error in pairs:
            # [s] since it was raised, by its own computer's clock
            age = (node.time_there(evidence.graph.time) - error.last_time) / 1e9
            if (age < _RECENT) == (severity is Severity.ERROR):
                fact = state("raised", node=node, **{n: getattr(error, n) for n in _RAISED})
                facts.append(fact.of("raised", f"{node.name} {error.exception}"))
                remedies.append(state("correct", node=node, place=error.place))
        yield from finding("callback-errors", facts, *remedies, severity=severity)


@rule(
    "logged",
    remedy="read the whole log: lcmtools echo /rosout",
    title="The following nodes log warnings or errors:",
    facts={"logged": "{node}: {level}: {text}{messages:count}"},
    remedies={"read-log": "read the whole log: `lcmtools echo /rosout`"},
    unless={"callback-errors": "raised", "type-mismatch": "topic", "undecodable": "topic"},
    evidence="messages on /rosout during the look",
)
def nodes_log_no_errors(evidence: Evidence) -> Iterator[Finding]:
    """Nodes log neither warnings nor errors on /rosout during the look.

    A simulator, for example, warns of wheels that it does not have. Exceptions of callbacks and
    messages of another type, which are logged too, are reported by other rules.
    """
    raising = {node.name: node.errors for node in evidence.graph.nodes if node.errors}
    facts = []
    for x in evidence.logs:
        named: dict[str, Part] = {"node": Subject("node", x.node), "level": x.level}
        raised = (e.exception for e in raising.get(x.node, ()) if e.exception in x.text)
        topic, separator, _ = x.text.partition(_IGNORED)
        fact = state("logged", **named, text=x.text, messages=x.count)
        fact = fact.of("topic", topic) if separator else fact
        facts.append(fact.of("raised", *(f"{x.node} {exception}" for exception in raised)))
    return finding("logged", facts, "read-log")
