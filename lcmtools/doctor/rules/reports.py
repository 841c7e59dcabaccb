"""Rules about reports of nodes: exceptions of their callbacks, and their logs."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Part, Severity, Subject, finding, rule, state

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
