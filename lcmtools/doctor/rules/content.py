"""Rules about what is in messages."""

from collections.abc import Iterator
from dataclasses import replace

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.doctor.rules.clocks import is_of_wrong_clock


@rule("not-finite", Severity.WARNING, "find where it divides by zero, and do not publish it")
def numbers_are_numbers(evidence: Evidence) -> Iterator[Finding]:
    """Published numbers are finite.

    A NaN passes through every later computation, and a robot that is told to drive at NaN m/s does
    anything. Ranges of lasers may be infinite.
    """
    yield from _odd(
        evidence,
        "not-finite",
        "Numbers that are published are none:",
        ("print the values where the node computes them",),
    )


@rule("quaternions", Severity.WARNING, "set w to 1 for no rotation, and normalise what is computed")
def rotations_are_rotations(evidence: Evidence) -> Iterator[Finding]:
    """Quaternions are rotations: their length is 1.

    All zeros is what a forgotten field holds, and means nothing.
    """
    yield from _odd(
        evidence,
        "quaternion",
        "Rotations that are published are none:",
        ("no rotation is x=0, y=0, z=0, w=1; divide others by their length",),
    )


@rule("covariances", Severity.WARNING, "fill both halves, and no negative number on the diagonal")
def covariances_are_covariances(evidence: Evidence) -> Iterator[Finding]:
    """Covariance matrices are symmetric, and variances not negative.

    A filter that gets another one diverges. -1 as the first number says that nothing is known.
    """
    yield from _odd(
        evidence,
        "covariance",
        "Covariances that are published are none:",
        (
            "set [row, column] and [column, row] to the same, and no [row, row] below 0",
            "where nothing is known, set the first number to -1",
        ),
    )


@rule(
    "stamps", Severity.WARNING, "set the clocks (chrony, ntp), or _use_sim_time:=true as the others"
)
def stamps_are_of_now(evidence: Evidence) -> Iterator[Finding]:
    """Messages are stamped with the time at which they are sent.

    Stamps in the future or long ago come from a clock that is wrong, or from a node that goes by
    another time than the simulator's. A computer whose clock differs is another rule's.
    """
    mine = [odd for odd in evidence.oddities if not is_of_wrong_clock(evidence, odd.name)]
    evidence = replace(evidence, oddities=mine)
    remedies = (
        "let both computers keep the time: sudo timedatectl set-ntp true",
        "where a simulator runs, start the node with _use_sim_time:=true",
    )
    yield from _odd(
        evidence, "future", "Messages are stamped with a time to come:", remedies, "stamps"
    )
    # a simulator that was killed or hangs is another rule's
    if not evidence.graph.topic("/clock").publishers and "/clock" not in evidence.hushed:
        text = "Messages are stamped with the time since a start, and nobody publishes /clock:"
        remedies_then = ("stamp with the time since 1970: time.time(), node.get_clock().now()",)
        yield from _odd(evidence, "boot", text, remedies_then, "stamps")
    text = "Times that are published are none:"
    yield from _odd(
        evidence, "nsec", text, ("sec, nsec = divmod(time.time_ns(), 1_000_000_000)",), "stamps"
    )
    old = [odd for odd in evidence.oddities if odd.kind == "old" and odd.count > 1]
    if old:
        yield from _odd(
            evidence, "old", "Messages are stamped with a time long ago:", remedies, "stamps"
        )


@rule("undecodable", Severity.WARNING, "generate the sender's types anew from the same .lcm files")
def messages_can_be_read(evidence: Evidence) -> Iterator[Finding]:
    """Messages can be decoded as the type that their fingerprint names."""
    yield from _odd(
        evidence,
        "undecodable",
        "Messages cannot be decoded:",
        ("let the sender use lcm-gen's code, unchanged",),
    )


def _odd(
    evidence: Evidence, kind: str, text: str, remedies: tuple[str, ...], identifier: str = ""
) -> Iterator[Finding]:
    names = {"quaternion": "quaternions", "covariance": "covariances"}
    rows = [
        f" * {odd.topic} from {odd.name}: {odd.text}"
        + (f" ({odd.count} messages)" if odd.count > 1 else "")
        for odd in evidence.oddities
        if odd.kind == kind
    ]
    if rows:
        yield Finding(
            identifier or names.get(kind, kind), Severity.WARNING, text, tuple(rows), remedies
        )
