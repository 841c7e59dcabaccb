"""The objects of a Gazebo world: an SDF file's static content, and the models that it includes.

Boxes, cylinders, spheres, capsules and planes are read, with their poses, masses, frictions and
colours. Links connected by joints become one rigid body. Meshes, lights etc. are left out and
counted; Gazebo's own settings (physics, plugins, gui) have no meaning here. The format is
that of http://sdformat.org/spec.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from lcmtools_sim.geometry import ORIGIN, Frame, Pose
from lcmtools_sim.scene import Scene, SceneObject
from lcmtools_sim.shapes import Inertial, centre_of_mass
from lcmtools_sim.world_file.markup import Element, load_markup
from lcmtools_sim.world_file.sdf_frames import Frames, SavedState, read_state
from lcmtools_sim.world_file.sdf_links import SdfLink, read_link
from lcmtools_sim.world_file.values import find_model, read_file

_BUILT_IN = ("model://sun", "model://ground_plane")
_COUNTED = ("light", "actor", "road", "population", "joint")
_MOST_MODELS = 5000
_NO_WORLD = "a robot (URDF) goes into the robots of a YAML world file: model: ./FILE"
_WORLD = "world"


def read_sdf(text: str, source: str, pose: Pose = ORIGIN) -> Scene:
    """Read an SDF file's text as a world without robots, with its origin at a pose in the world.

    ``source`` is its path, for messages and for files beside it. The scene's notes name the
    elements that were left out.
    """
    root = load_markup(text, source, "sdf", _NO_WORLD)
    worlds, plain = root.all("world"), Scene("")
    if not worlds and not root.all("model"):
        raise root.error("the file contains neither a <world> nor a <model>")
    holder = worlds[0] if worlds else root
    reader = _Reader([Path(source).resolve()], pose.frame, read_state(holder))
    try:
        reader.read(holder)
    except RecursionError:
        raise holder.error("too many frames are relative to each other") from None
    gravity = _gravity(holder)
    return Scene(
        name=Path(source).stem,
        node="gazebo",
        gravity=plain.gravity if gravity is None else gravity,
        ground=next((link.ground for link in reader.links if link.ground), plain.ground),
        objects=tuple(reader.objects),
        notes=reader.notes(source),
    )


def _gravity(world: Element) -> float | None:
    found = world.child("gravity") or world.path("physics", "gravity")
    if found is None:
        return None
    x, y, z = found.vector()
    if x or y or z > 0 or z < -100:  # noqa: PLR2004 - the same bound as for a YAML file's gravity
        raise found.error("gravity must be 0 0 -G, with G from 0 to 100")
    return -z


@dataclass(slots=True)
class _Model:
    """The links and joints of one model, with those of its nested models."""

    links: dict[str, SdfLink] = field(default_factory=dict)
    joints: list[tuple[str, str, str]] = field(default_factory=list)  # name, parent and child


class _Outer(NamedTuple):
    """The model or world around an element: its frame in the simulated world, those in it."""

    frame: Frame
    frames: Frames


class _Reader:
    """Reads a file and its includes; ``opened`` are the files being read, outermost first.

    ``origin`` is the frame of the file's world, and ``state`` its saved state.
    """

    def __init__(self, opened: list[Path], origin: Frame, state: SavedState) -> None:
        self.links: list[SdfLink] = []
        self.objects: list[SceneObject] = []
        self._opened = opened
        self._origin = origin
        self._state = state
        self._models = 0
        self._left_out = Counter({"scale in the saved state": state.scaled} if state.scaled else {})
        self._not_found: Counter[str] = Counter()

    def notes(self, source: str) -> tuple[str, ...]:
        """Return notes on the elements that were left out."""
        parts = [f"{kind} ({count})" for kind, count in sorted(self._left_out.items())]
        parts += [f"{uri} (not found, {count})" for uri, count in sorted(self._not_found.items())]
        return (f"{source}: left out: {', '.join(parts)}",) if parts else ()

    def read(self, holder: Element) -> None:
        """Read the models of a world."""
        outer = _Outer(self._origin, Frames(holder))
        for element in (*holder.children, *self._state.added):
            if element.tag in ("model", "include"):
                model = _Model()
                self._member(element, outer, model, "", static=False)
                self.links += model.links.values()
                groups = _groups(model.links, self._known_joints(model))
                self.objects += [found for group in groups if (found := _object(group))]
            elif element.tag in _COUNTED:
                self._left_out[element.tag] += 1

    def _known_joints(self, model: _Model) -> list[tuple[str, str]]:
        """Return the pairs of joined links; as in Gazebo, a joint to any other is left out."""
        known = []
        for name, parent, child in model.joints:
            lost = [end for end in (parent, child) if end not in (*model.links, _WORLD)]
            if lost:
                self._left_out[f"joint {name}, as there is no link {lost[0]}"] += 1
            else:
                known.append((parent, child))
        return known

    def _member(
        self, element: Element, outer: _Outer, into: _Model, prefix: str, *, static: bool
    ) -> None:
        """Read a model, or an included one with the include's name, pose etc."""
        if element.tag == "model":
            self._model(element, outer, into, prefix, static=static)
            return
        uri = element.needed("uri").words()
        path = find_model(uri, element.source)
        if path is None:
            if uri not in _BUILT_IN:
                self._not_found[uri] += 1
            return
        if path.resolve() in self._opened:
            raise element.error(f"{path} includes itself")
        self._opened.append(path.resolve())
        root = load_markup(read_file(path), str(path), "sdf")
        if model := root.child("model"):
            self._model(_overridden(model, element), outer, into, prefix, static=static)
        elif root.child("light"):
            self._left_out["light"] += 1
        else:
            raise element.error(f"{path} contains no <model>")
        self._opened.pop()

    def _model(
        self, element: Element, outer: _Outer, into: _Model, prefix: str, *, static: bool
    ) -> None:
        self._models += 1
        if self._models > _MOST_MODELS:
            raise element.error(f"the world has more than {_MOST_MODELS} models")
        name = prefix + element.attribute("name")
        if name in self._state.removed:
            return
        frame = self._saved(name) or outer.frame.place(outer.frames.pose(element))
        inside = _Outer(frame, Frames(element))
        flag = element.child("static")
        static = static or (flag is not None and flag.text.strip().lower() in ("true", "1"))
        for child in element.children:
            if child.tag == "link":
                link = f"{name}::{child.attribute('name')}"
                if link in into.links:
                    raise child.error(f"two links of the model are named '{link}'")
                place = self._saved(link) or frame.place(inside.frames.pose(child))
                found = read_link(child, place, inside.frames, self._left_out, static=static)
                into.links[link] = replace(found, name=link)
            elif child.tag == "joint":
                self._joint(child, into, name, inside.frames)
            elif child.tag in ("model", "include"):
                self._member(child, inside, into, f"{name}::", static=static)

    def _saved(self, name: str) -> Frame | None:
        """Return the frame of a model or link in the saved state; None if it is not there."""
        found = self._state.poses.get(name)
        return self._origin.place(found) if found else None

    def _joint(self, element: Element, into: _Model, model: str, frames: Frames) -> None:
        parent, child = (element.needed(tag).words() for tag in ("parent", "child"))
        if element.attributes.get("type") != "fixed":
            self._left_out["movement of a joint"] += 1
        parent, child = (
            end if end == _WORLD else f"{model}::{frames.link_of(end)}" for end in (parent, child)
        )
        into.joints.append((f"{model}::{element.attributes.get('name', '')}", parent, child))


def _overridden(model: Element, include: Element) -> Element:
    """Return an included model with the include's pose, name etc."""
    own = [child for tag in ("pose", "static") if (child := include.child(tag))]
    kept = [child for child in model.children if child.tag not in {one.tag for one in own}]
    name = include.child("name")
    attributes = {**model.attributes, **({"name": name.words()} if name else {})}
    if placed := include.child("placement_frame"):
        attributes["placement_frame"] = placed.words()
    return Element(model.tag, model.source, model.line, attributes, [*own, *kept])


def _groups(links: Mapping[str, SdfLink], joints: Iterable[tuple[str, str]]) -> list[list[SdfLink]]:
    """Return the links of each body: static ones alone, movable ones with those joined to them.

    Links that are joined to the world are static.
    """
    leader = {name: name for name in (*links, _WORLD)}

    def top(name: str) -> str:
        while leader[name] != name:
            leader[name] = name = leader[leader[name]]  # halves the path for the next one
        return name

    for parent, child in joints:
        leader[top(child)] = top(parent)
    groups: dict[str, list[SdfLink]] = {}
    for name, link in links.items():
        fixed = link.static or top(name) == top(_WORLD)
        groups.setdefault(name if fixed else top(name), []).append(replace(link, static=fixed))
    return list(groups.values())


def _object(links: list[SdfLink]) -> SceneObject | None:
    """Return one body of the links; None without any shape."""
    parts = [part for link in links for part in link.parts]
    if not parts:
        return None
    mass, centre = centre_of_mass(Inertial(link.mass, link.frame) for link in links)
    frame = Frame(centre, links[0].frame.rotation)
    inside = frame.inverse()
    return SceneObject(
        name=links[0].name.removesuffix("::link"),
        parts=tuple(part.placed(*inside) for part in parts),
        pose=frame.pose(),
        mass=0.0 if links[0].static else mass,
        friction=links[0].friction,
    )
