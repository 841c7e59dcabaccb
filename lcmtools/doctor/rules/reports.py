"""Rules about reports of nodes: exceptions of their callbacks, and their logs."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, LogLine
from lcmtools.doctor.findings import Finding, Severity, Subject, finding, rule, state
from lcmtools.doctor.rules.types import disagree

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
                facts.append(state("raised", node=node, **{n: getattr(error, n) for n in _RAISED}))
                remedies.append(state("correct", node=node, place=error.place))
        yield from finding("callback-errors", facts, *remedies, severity=severity)


@rule(
    "logged",
    remedy="read the whole log: lcmtools echo /rosout",
    title="The following nodes log warnings or errors:",
    facts={"logged": "{node}: {level}: {text}{messages:count}"},
    remedies={"read-log": "read the whole log: `lcmtools echo /rosout`"},
    evidence="messages on /rosout during the look",
)
def nodes_log_no_errors(evidence: Evidence) -> Iterator[Finding]:
    """Nodes log neither warnings nor errors on /rosout during the look.

    A simulator, for example, warns of wheels that it does not have. Exceptions of callbacks and
    messages of another type, which are logged too, are reported by other rules.
    """
    raising = {node.name: node.errors for node in evidence.graph.nodes if node.errors}
    facts = [
        state("logged", node=Subject("node", x.node), level=x.level, text=x.text, messages=x.count)
        for x in evidence.logs
        if not any(error.exception in x.text for error in raising.get(x.node, ()))
        if not _is_of_wrong_message(x, evidence)
    ]
    return finding("logged", facts, "read-log")


def _is_of_wrong_message(line: LogLine, evidence: Evidence) -> bool:
    """Return whether a node logs a message that it cannot decode, which another rule reports."""
    topic, separator, _ = line.text.partition(_IGNORED)
    is_odd = any(odd.topic == topic and odd.kind == "undecodable" for odd in evidence.oddities)
    return bool(separator) and (is_odd or disagree(evidence.graph.topic(topic)))
