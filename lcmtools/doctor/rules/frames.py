"""Rules about coordinate frames and their transforms."""

from collections import defaultdict
from collections.abc import Iterator, Mapping

from lcmtools.doctor.evidence import Evidence, FrameParent
from lcmtools.doctor.findings import Finding, finding, rule, state
from lcmtools.doctor.rules.shared import DECODED


@rule(
    "frames",
    remedy="send each child_frame_id from one program, below one header.frame_id",
    title={
        "frame-loop": "The following frames form a loop:",
        "frame-parents": "The following frames have several parents:",
    },
    facts={
        "frame-loop": "{frames}, from {senders:and}",
        "frame-parents": "{frame} is in {parents:and}",
    },
    remedies={
        "exchange-frames": "header.frame_id is the parent, child_frame_id the child: swap them in"
        " one of the transforms",
        "one-parent": "let one program publish the pose of a frame, in one header.frame_id, or"
        " give the frames of different things different names",
    },
    evidence=DECODED,
)
def frames_are_trees(evidence: Evidence) -> Iterator[Finding]:
    """Frames form trees: each has one parent at most, and none is below itself.

    With two parents, who looks a transform up gets now the one, now the other; in a circle nothing
    can be looked up.
    """
    trees: dict[str, dict[str, list[FrameParent]]] = defaultdict(lambda: defaultdict(list))
    for one in sorted(evidence.frames, key=repr):  # the same in each look
        trees[one.tree][one.child].append(one)
    several, loops = [], []
    for tree in trees.values():
        for child, links in tree.items():
            if len({one.parent for one in links}) > 1:
                parents = [f"{one.parent} (by {one.name})" for one in links]
                several.append(state("frame-parents", frame=child, parents=tuple(parents)))
        for loop in _loops({child: links[0].parent for child, links in tree.items()}):
            senders = dict.fromkeys(tree[child][0].name for child in loop)
            way = " -> ".join((*loop, loop[0]))
            loops.append(state("frame-loop", frames=way, senders=senders))
    yield from finding("frame-parents", several, "one-parent")
    yield from finding("frame-loop", loops, "exchange-frames")


def _loops(parents: Mapping[str, str]) -> list[tuple[str, ...]]:
    """Return each loop once, each frame before its parent."""
    circles: dict[frozenset[str], tuple[str, ...]] = {}
    for start in parents:
        path, frame = [], start
        while frame in parents and frame not in path:
            path.append(frame)
            frame = parents[frame]
        if frame in path:
            circle = tuple(path[path.index(frame) :])
            circles.setdefault(frozenset(circle), circle)
    return list(circles.values())
