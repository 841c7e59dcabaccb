"""The frames of a model or world in SDF: poses relative to links, joints, frames and models.

Also the poses that Gazebo saves in ``<state>``, which replace those of the models. The format is
that of http://sdformat.org/tutorials?tut=pose_frame_semantics.
"""

import math
from dataclasses import dataclass, field

from lcmtools.names import did_you_mean
from lcmtools_sim.geometry import Frame, Pose
from lcmtools_sim.world_file.markup import Element

_NAMED = ("link", "joint", "frame", "model")


class Frames:
    """The frames of one model or world, each in that of the model or world, by name."""

    def __init__(self, holder: Element) -> None:
        self._holder = holder
        named = (child for child in holder.children if child.tag in _NAMED)
        self._elements = {child.attributes.get("name", ""): child for child in named}
        own = "__model__" if holder.tag == "model" else "world"
        self._found = {"": Frame(), own: Frame()}
        self._open: set[str] = set()

    def pose(self, element: Element) -> Frame:
        """Return the frame of an element of the model."""
        pose = element.child("pose") or element
        frame = self.of(relative_to(element) or _default(element), pose).place(read_pose(element))
        placed = element.attributes.get("placement_frame", "")
        return frame.place(Frames(element).of(placed, element).inverse()) if placed else frame

    def of(self, name: str, asked: Element) -> Frame:
        """Return the frame with a name; ``asked`` names it, for messages."""
        if name not in self._found:
            self._found[name] = self._read(name, asked)
        return self._found[name]

    def link_of(self, name: str) -> str:
        """Return the link to which a frame is attached; a link is its own."""
        for _ in self._elements:
            element = self._elements.get(name)
            if element is None or element.tag not in ("frame", "joint"):
                break
            name = _default(element)
        return name

    def _read(self, name: str, asked: Element) -> Frame:
        first, _, rest = name.partition("::")
        element = self._elements.get(first)
        if element is None or (rest and element.tag != "model"):
            hint = did_you_mean(name, self._elements) or "frames of included files are not read"
            raise asked.error(f"there is no frame '{name}' in {self._holder}", hint)
        if first in self._open:
            raise asked.error(f"the pose of '{first}' is relative to itself")
        self._open.add(first)
        frame = self.pose(element)
        self._open.remove(first)
        return frame.place(Frames(element).of(rest, asked)) if rest else frame


def relative_to(element: Element) -> str:
    """Return the frame that an element's pose names; "" for the usual one."""
    pose = element.child("pose")
    return (
        (pose.attributes.get("relative_to") or pose.attributes.get("frame") or "") if pose else ""
    )


def _default(element: Element) -> str:
    """Return the frame in which an element's pose is, if it names none."""
    if element.tag == "joint":
        return element.needed("child").words()
    return element.attributes.get("attached_to", "") if element.tag == "frame" else ""


def read_pose(element: Element) -> Frame:
    """Read the pose of an element, in the frame that it is relative to."""
    pose = element.child("pose")
    if pose is None or not pose.text.strip():
        return Frame()
    x, y, z, *angles = pose.numbers("", (6, 7))
    if len(angles) == 4:  # noqa: PLR2004 - a quaternion
        size = math.hypot(*angles)
        if not size:
            raise pose.error("the rotation is all zeros", "0 0 0 1 for none")
        qx, qy, qz, qw = (value / size for value in angles)
        return Frame((x, y, z), (qx, qy, qz, qw))
    if pose.attributes.get("degrees") in ("true", "1"):
        angles = [math.radians(angle) for angle in angles]
    return Pose(x, y, z, *angles).frame


@dataclass(slots=True)
class SavedState:
    """The state of a saved world: the poses of models and links in the world, and more."""

    poses: dict[str, Frame] = field(default_factory=dict)  # by full name ("crate::link")
    scaled: int = 0  # number of models whose size was changed
    added: list[Element] = field(default_factory=list)  # models
    removed: set[str] = field(default_factory=set)  # names of models


def read_state(world: Element) -> SavedState:
    """Read the first ``<state>`` of a world, as Gazebo does."""
    state, element = SavedState(), world.child("state")
    if element is not None:
        _add_poses(state, element, "")
        for part in element.all("insertions"):
            state.added += [child for child in part.children if child.tag in ("model", "include")]
        for part in element.all("deletions"):
            state.removed.update(name.words() for name in part.all("name"))
    return state


def _add_poses(state: SavedState, holder: Element, prefix: str) -> None:
    for element in (child for child in holder.children if child.tag in ("model", "link")):
        name = prefix + element.attribute("name")
        if element.child("pose"):
            state.poses[name] = read_pose(element)
        scale = element.child("scale")
        state.scaled += scale is not None and scale.vector() != (1.0, 1.0, 1.0)
        _add_poses(state, element, f"{name}::")
