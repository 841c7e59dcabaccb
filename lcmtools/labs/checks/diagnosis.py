"""Diagnosis: the cause of a failed row, from the observations of the program.

Pure functions of the record, for all labs. Values that are specific to a lab are judged in the
modules of its checks.
"""

import math
import re
import signal
from collections.abc import Mapping, Sequence
from dataclasses import replace

from lcmtools.doctor.connecting import renaming
from lcmtools.doctor.renaming import resembles
from lcmtools.doctor.sentences import remedy_text
from lcmtools.graph.model import NodeInfo
from lcmtools.labs.catalogue import LabProgram
from lcmtools.labs.checks.observations import (
    BusLook,
    Failure,
    Observations,
    last_failure,
    last_words,
)
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.messages.registry import Message
from lcmtools.names import base_name_of, namespace_of
from lcmtools.packages.runnable_nodes import in_place_of_ros
from lcmtools.types.geometry_msgs import Twist

DIED = "died"  # the key of a row's cause: the program has ended
SILENT, SELDOM, ZERO = "silent", "seldom", "zero"
"""Nothing has come of the program, or too little, or nothing that moves the robot."""
SAME = "same"  # the cause is that of the row before
RAISED, IGNORED = "raised", "ignored"
"""Its callbacks raise exceptions; the simulator ignores its commands."""
TYPE, TOPIC, SUBSCRIPTION, UNSUBSCRIBED = "type", "topic", "subscription", "unsubscribed"
TIMER = "timer"
STOPPED = "stopped"  # commands came, and then no more
STRAYS, UNLIKE = "strays", "unlike"
"""It strays from the path, or its picture is another one: input from another topic explains it."""
UNMOVED = "unmoved-"  # the beginning of the key, before the field that has no effect
LASTING = (RAISED, TYPE, TOPIC, SUBSCRIPTION, TIMER)
"""Keys of the causes that time does not mend; others may be of a program that starts slowly."""

_LONG_CALL, _LONG_MEAN = 1.0, 0.1  # [s]
_NOT_FOUND = 127  # the exit code of a shell, and of env, for a program that is not there
_RARE = 10  # calls for each exception
_MISSING = re.compile(r"No module named '([\w.]+)'")
_LONG_TIMER = re.compile(r"create_timer: a period of .+")  # as a node warns
_SMALL = 1e-6
_SLIPS = (
    (
        re.compile(r"Vector3\b.*\Ww\W"),
        "the angular part of a Twist has no w, whatever older texts print: leave that line out",
    ),
    (
        re.compile(r"no matching (?:member )?function .*create_(publisher|subscription)\("),
        "write the message's type: create_{}<geometry_msgs::Twist>(...)",
    ),
    (
        re.compile(r"no matching function .*make_(shared)\(\)"),
        "write the class: std::make_{}<MovingRobot>()",
    ),
)
"""Errors that come of the printed texts of the labs, and what to write instead."""
_RENAMINGS = {
    "drop-remap": "start it without {argument}",
    "namespace": "start it with __ns:={namespace}",
    "remap": "change the name in it, or start it with {old}:={new}",
    "remove-slash": "it begins with /, so __ns:={namespace} does not apply: write '{name}'",
    "remove-slash-of-remap": "it begins with /, so neither __ns:={namespace} nor {argument}"
    " applies: write '{name}'",
    "replace-remap": "start it with {old}:={new} in place of {argument}",
    "republish": "let it publish on '{topic}'",
    "subscribe": "let it subscribe to {channel}",
}
"""The remedies of ``doctor.connecting`` in the words of a lab."""
_NO_SPIN = "does it call spin(node), or spin_once often?"


def cause_of(result: CheckResult, observed: Observations) -> Cause:
    """Return the cause of a failed row."""
    given = Cause(result.cause or result.what, result.hint)
    if result.cause == DIED or (observed.code not in (None, 0)):
        return died(observed)
    is_silent = result.cause == SILENT
    found = raised(observed, frequent_only=not is_silent)
    found = misled(observed, result) or found or ignored(observed)
    stops = result.cause in (SILENT, SELDOM, STOPPED, ZERO)
    if not found and (stops or observed.program.publishes):
        found = busy(observed, often=not stops)
    if not found and is_silent:
        found = disconnected(observed, result.hint)
    return found or given


def died(observed: Observations) -> Cause:
    """Return the cause if the program has ended too early."""
    words = last_words(observed.printed) or "it printed nothing"
    code = observed.code or 0
    how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
    end = "; a node runs as long as it spins: spin(node)" if code == 0 else ""
    if code == _NOT_FOUND and r"\r" in observed.printed:  # as env writes a carriage return
        end = r"; its lines end as on Windows: sed -i 's/\r$//' FILE, or run it by python"
    return Cause(DIED, f"the program died: it {how}: {words}{end or _missing_module(words)}")


def _missing_module(words: str) -> str:
    """Return the replacement for a missing module of ROS, or for another slip."""
    own = in_place_of_ros(match[1]) if (match := _MISSING.search(words)) else slip(words)
    return f"; {own}" if own else ""


def misled(observed: Observations, result: CheckResult) -> Cause | None:
    """Return the wrong input topic if the callback for it raises, or if the row is about it."""
    look, wanted = observed.look, observed.program.subscribes
    found = _not_hearing(look, observed.program) if look else None
    if look is None or found is None or found.key != SUBSCRIPTION:
        return None
    others = {wire.topic for wire in look.subscriptions if wire.topic not in wanted}
    raises = any(failure.callback in others for failure in look.failures)
    is_about = result.cause in (SELDOM, ZERO, STRAYS, UNLIKE)
    return found if raises or is_about or result.cause.startswith(UNMOVED) else None


def raised(observed: Observations, *, frequent_only: bool = False) -> Cause | None:
    """Return the exception that its callbacks raise, if any.

    With ``frequent_only``, only callbacks that raise most of the time count: a rare exception does
    not explain wrong motion.
    """
    failures = list(observed.look.failures) if observed.look else []
    if not failures and (printed := last_failure(observed.printed)):
        failures = [printed]
    if frequent_only:
        failures = [failure for failure in failures if not _is_rare(failure, observed)]
    if not failures:
        return None
    failure = max(failures, key=lambda failure: failure.count)
    times = f" {failure.count} times" if failure.count > 1 else ""
    where = f"its callback of {failure.callback}" if failure.callback else "it"
    text = "; ".join(filter(None, (f"{where} raised{times} {failure}", slip(failure.message))))
    return Cause(RAISED, text)


def _is_rare(failure: Failure, observed: Observations) -> bool:
    """Return True if most calls of the callback succeed, by the numbers of calls or of commands."""
    inputs = observed.look.subscriptions if observed.look else ()
    calls = next((wire.calls for wire in inputs if wire.topic == failure.callback), 0)
    return _RARE * failure.count < (calls or len(observed.commands))


def ignored(observed: Observations) -> Cause | None:
    """Return the reason why the simulator ignores its commands, if it does."""
    for text in observed.warnings:
        topic, found, reason = text.partition(": command ignored: ")
        if found:
            return Cause(IGNORED, f"the robot ignores its commands on {topic}: {reason}")
    return None


def busy(observed: Observations, *, often: bool = False) -> Cause | None:
    """Return the callback that does not return at once, if there is one.

    With ``often`` the longest call does not count: it may have loaded what the others need.
    """
    for wire in observed.look.subscriptions if observed.look else ():
        calls, spent = wire.calls - often, wire.busy - often * wire.longest
        is_long = wire.longest > _LONG_CALL and not often
        if is_long or (calls > 0 and spent / calls > _LONG_MEAN):
            text = f"its callback of {wire.topic} runs for {wire.longest:.1f} s: it must return at"
            return Cause("busy", f"{text} once, without a sleep or a loop that waits")
    return None


def slip(error: str) -> str:
    """Return what to write instead of a slip that printed texts of the labs have; "" for others."""
    found = ((pattern.search(error), text) for pattern, text in _SLIPS)
    return next((text.format(*match.groups()) for match, text in found if match), "")


def disconnected(observed: Observations, hint: str = "") -> Cause | None:
    """Return the reason why a running program sends nothing, if the bus shows it; else a hint."""
    look, program = observed.look, observed.program
    if look is None:
        return None
    if not (look.nodes or look.publications):
        text = "neither a node nor a message of it is on the check's bus: does it create its node,"
        return Cause("no-node", f"{text} and take the bus from LCM_DEFAULT_URL?")
    is_bare = not (look.publications or look.subscriptions)
    if is_bare and program.publishes and not program.has_keys:
        return Cause("publisher", f"it does not create a publisher of {program.publishes[0]}")
    wrong = _elsewhere(look, program) or _not_hearing(look, program)
    if wrong or program.has_keys:
        return wrong
    if warning := _LONG_TIMER.search(observed.printed):
        return Cause(TIMER, f"its timer has not been called yet: {warning[0]}")
    return _not_publishing(look, program.publishes, hint)


def _elsewhere(look: BusLook, program: LabProgram) -> Cause | None:
    """Return the wrong topic or type that it publishes."""
    wanted, types = program.publishes, program.types
    if not wanted:
        return None
    here = [wire for wire in look.publications if wire.topic in wanted]
    odd = next((wire for wire in here if wire.type and wire.type not in types), None)
    if odd:
        expected = " or ".join(types)
        text = f"it publishes {odd.type} on {odd.topic}, but {expected} is expected"
        return Cause(TYPE, text)
    if here:
        return None
    others = [w for w in look.publications if w.type in types or _is_near(w.topic, wanted)]
    if not others:
        return None
    other = max(others, key=lambda wire: (_is_near(wire.topic, wanted), wire.messages))
    target = next((name for name in wanted if _is_near(other.topic, [name])), wanted[0])
    return Cause(
        TOPIC,
        f"it publishes on {other.topic}, and not on {target}:"
        f" {_renaming(look, program, other.topic, target, publishes=True)}",
    )


def _not_hearing(look: BusLook, program: LabProgram) -> Cause | None:
    """Return the topic that it does not subscribe to, unless it is a plain LCM program."""
    wanted = program.subscribes
    odd = next((wire for wire in look.subscriptions if wire.offered), None)
    if odd:
        return Cause(
            TYPE, f"it subscribes to {odd.topic} as {odd.type}, but {odd.offered} is published"
        )
    have = [wire.topic for wire in look.subscriptions]
    for topic in wanted if look.nodes else ():
        if topic in have:
            continue
        others = [name for name in have if name not in wanted]
        near = [name for name in others if _is_near(name, [topic])]
        if not others:
            return Cause(UNSUBSCRIBED, f"it does not subscribe to {topic}")
        other = (near or others)[0]
        remedy = _renaming(look, program, other, topic, publishes=False)
        return Cause(SUBSCRIPTION, f"it subscribes to {other}, and not to {topic}: {remedy}")
    return None


def _not_publishing(look: BusLook, wanted: Sequence[str], hint: str) -> Cause | None:
    if not look.nodes:
        return None
    if not look.runs_callbacks:
        return Cause("spin", f"no callback of its node was ever called: {_NO_SPIN}")
    calls = max((wire.calls for wire in look.subscriptions), default=0)
    runs = f"its callbacks run (calls: {calls}), but " if calls else ""
    if not wanted:
        return Cause("output", f"{runs}they have no visible effect: {hint}") if calls else None
    if any(wire.topic in wanted for wire in look.publications):
        return Cause("publish", f"{runs}publish() is never called for {wanted[0]}")
    return Cause("publisher", f"{runs}it does not create a publisher of {wanted[0]}")


def _is_near(topic: str, wanted: Sequence[str]) -> bool:
    return any(resembles(topic, name) for name in wanted)


def _renaming(look: BusLook, program: LabProgram, old: str, new: str, *, publishes: bool) -> str:
    """Return the remedy for a topic that the program names wrongly, by the table of wtf."""
    if not look.nodes:  # a program without lcmtools has no remaps
        return "change the name in it"
    names = sorted(look.nodes, key=lambda name: namespace_of(name) != namespace_of(new))
    node = NodeInfo(names[0], "", "", 0, command=" ".join(program.arguments))
    here = namespace_of(node.name)
    is_misplaced = here == namespace_of(old) and f"__ns:={namespace_of(new)}" in program.arguments
    remedy = renaming(node, old, new, publishes=publishes, is_misplaced=is_misplaced)
    parts = {"namespace": here, **remedy.parts}
    if "new" in parts and here == namespace_of(old) == namespace_of(new):
        parts["new"] = base_name_of(new)
    return remedy_text(replace(remedy.worded(_RENAMINGS), parts=parts))


def misplaced(twist: Twist) -> Cause | None:
    """Return a cause if fields of a Twist are set that a wheeled robot ignores."""
    values = {
        f"{part}.{axis}": getattr(getattr(twist, part), axis)
        for part in ("linear", "angular")
        for axis in "xyz"
    }
    wrong = [n for n, v in values.items() if abs(v) > _SMALL and n not in ("linear.x", "angular.z")]
    if not wrong:
        return None
    text = f"it sets {' and '.join(wrong)}: forward is linear.x, a turn to the left is angular.z"
    return Cause("field", text)


def velocity_of(message: Message | None) -> tuple[float, float] | None:
    """Return the forward speed and turn rate of a Twist; None for anything else."""
    return (message.linear.x, message.angular.z) if isinstance(message, Twist) else None


def explain_number(measured: float, formulas: Mapping[str, float]) -> str:
    """Return the formula whose value is closest to the measured one; "" if none is close."""
    name = min(formulas, key=lambda name: abs(formulas[name] - measured))
    return name if math.isclose(measured, formulas[name], rel_tol=0.02) else ""
