"""The content of a URDF file: links of simple shapes with masses, joined to one body.

Every joint is at zero. Drives are not known here, see urdf_robot.py. The format is that of
http://wiki.ros.org/urdf/XML.
"""

import re
from dataclasses import dataclass
from pathlib import PurePath

from lcmtools.errors import InvalidFile
from lcmtools_sim.geometry import ZERO, Frame, Pose
from lcmtools_sim.shapes import (
    GREY,
    Color,
    Cuboid,
    Cylinder,
    Inertial,
    Part,
    Shape,
    Sphere,
    is_possible,
)
from lcmtools_sim.world_file.markup import Element, load_markup

_BASE = "base_link"
_COMMENT = re.compile("<!--.*?-->", re.DOTALL)
_XACRO = re.compile(r"<xacro:|\$[{(]|<(?:property|macro)\s")  # with or without its namespace
_TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass(frozen=True, slots=True)
class Link:
    """A link of the robot, in the frame of its base."""

    element: Element  # its source, for messages
    frame: Frame  # of the link itself
    parts: tuple[Part, ...]  # its collision shapes, or, without any, its visual ones
    inertial: Inertial | None  # its mass properties; None without mass


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint between two links, by name."""

    element: Element
    kind: str  # URDF's type: fixed, continuous, revolute and so on
    parent: str
    child: str
    frame: Frame  # the child's in the parent, at zero


@dataclass(frozen=True, slots=True)
class Urdf:
    """A robot's description."""

    root: Element  # the root element, for messages
    name: str  # the robot's
    links: dict[str, Link]  # by name, in the frame of base_link, or of the first link without one
    joints: dict[str, Joint]  # by name
    notes: tuple[str, ...]  # notes on links that were left out, or whose inertia is impossible


def read_urdf(text: str, source: str) -> Urdf:
    """Read a URDF file's text; ``source`` is its name, for messages."""
    _refuse_xacro(text, source)
    root = load_markup(text, source, "robot")
    elements = _by_name(root, "link")
    if not elements:
        raise root.error("the robot has no links", "give it a <link name='base_link'>")
    joints = {name: _joint(element) for name, element in _by_name(root, "joint").items()}
    frames = _frames(root, elements, joints)
    colors = _colors(root)
    links = {name: _link(elements[name], frame, colors) for name, frame in frames.items()}
    notes = tuple(
        f"{link.place}: link '{name}' is left out: it is a mesh"
        for name, link in elements.items()
        if not link.all("collision") and any(v.path("geometry", "mesh") for v in link.all("visual"))
    )
    notes += tuple(
        f"{link.element.place}: no body has the inertia of link '{name}': the engine changes it"
        for name, link in links.items()
        if link.inertial and not is_possible(link.inertial)
    )
    return Urdf(root, root.attribute("name"), links, joints, notes)


def _refuse_xacro(text: str, source: str) -> None:
    if source.endswith(".xacro") or _XACRO.search(_COMMENT.sub("", text)):
        plain = PurePath(source.removesuffix(".xacro")).with_suffix(".urdf").name
        if plain == PurePath(source).name:  # the file would be emptied before xacro reads it
            plain = f"plain_{plain}"
        what = f"{source}: it is a xacro file, which must be expanded first"
        raise InvalidFile(what, f"type: xacro {PurePath(source).name} > {plain}")


def _by_name(root: Element, tag: str) -> dict[str, Element]:
    found: dict[str, Element] = {}
    for element in root.all(tag):
        name = element.attribute("name")
        if name in found:
            raise element.error(f"two {tag}s are named '{name}'")
        found[name] = element
    return found


def _joint(element: Element) -> Joint:
    return Joint(
        element,
        element.attribute("type"),
        element.needed("parent").attribute("link"),
        element.needed("child").attribute("link"),
        _origin(element),
    )


def _frames(root: Element, links: dict[str, Element], joints: dict[str, Joint]) -> dict[str, Frame]:
    """Return the frame of each link in the base; all must form one tree."""
    above: dict[str, Joint] = {}
    for joint in joints.values():
        element = joint.element
        for name in (joint.parent, joint.child):
            if name not in links:
                raise element.error(f"{element} joins a link '{name}' that does not exist")
        if joint.child in above:
            raise element.error(f"the link '{joint.child}' has two parents")
        above[joint.child] = joint
    tops = [name for name in links if name not in above]
    if len(tops) != 1:
        held = "every link has a parent" if not tops else f"{' and '.join(tops)} are not joined"
        raise root.error(f"the links must form one tree: {held}")
    in_root = _from_root(tops[0], joints)
    if len(in_root) < len(links):
        lost = next(name for name in links if name not in in_root)
        raise links[lost].error(f"the link '{lost}' is its own ancestor")
    to_base = in_root[_BASE if _BASE in links else tops[0]].inverse()
    return {name: to_base.place(in_root[name]) for name in links}


def _from_root(top: str, joints: dict[str, Joint]) -> dict[str, Frame]:
    below: dict[str, list[Joint]] = {}
    for joint in joints.values():
        below.setdefault(joint.parent, []).append(joint)
    found, waiting = {top: Frame()}, [top]
    while waiting:
        parent = waiting.pop()
        for joint in below.get(parent, []):
            found[joint.child] = found[parent].place(joint.frame)
            waiting.append(joint.child)
    return found


def _link(element: Element, frame: Frame, colors: dict[str, Color]) -> Link:
    color = _look(element, colors)
    shapes = element.all("collision") or [
        visual for visual in element.all("visual") if not visual.path("geometry", "mesh")
    ]
    parts = tuple(
        Part(_shape(element, one.needed("geometry")), *_origin(one), color).placed(*frame)
        for one in shapes
    )
    return Link(element, frame, parts, _inertial(element, frame))


def _shape(link: Element, geometry: Element) -> Shape:
    if found := geometry.child("box"):
        return Cuboid(found.size("size"))
    if found := geometry.child("cylinder"):
        return Cylinder(found.length("radius"), found.length("length"))
    if found := geometry.child("sphere"):
        return Sphere(found.length("radius"))
    kind = geometry.children[0].tag if geometry.children else "nothing"
    what = f"link '{link.attribute('name')}' has a shape of <{kind}>"
    hint = "boxes, cylinders and spheres are supported: give it one as <collision>"
    raise geometry.error(what, hint)


def _inertial(link: Element, frame: Frame) -> Inertial | None:
    element = link.child("inertial")
    if element is None:
        return None
    mass = element.needed("mass").number("value", lowest=0.0)
    inertia = element.needed("inertia")
    xx, yy, zz, xy, xz, yz = (
        inertia.number(name, lowest=0.0 if name[1] == name[2] else -1e6)
        if name in inertia.attributes or name[1] == name[2]
        else 0.0
        for name in _TENSOR
    )
    return Inertial(mass, frame.place(_origin(element)), (xx, yy, zz, xy, xz, yz))


def _origin(element: Element) -> Frame:
    origin = element.child("origin")
    if origin is None:
        return Frame()
    place, angles = (
        origin.vector(name) if name in origin.attributes else ZERO for name in ("xyz", "rpy")
    )
    return Pose(*place, *angles).frame


def _colors(root: Element) -> dict[str, Color]:
    visuals = [visual for link in root.all("link") for visual in link.all("visual")]
    found: dict[str, Color] = {}
    for material in (m for holder in (root, *visuals) for m in holder.all("material")):
        name, color = material.attributes.get("name"), _rgb(material)
        if name and color:
            found.setdefault(name, color)
    return found


def _look(link: Element, colors: dict[str, Color]) -> Color:
    """Return the first colour of a link's visuals."""
    for visual in link.all("visual"):
        for material in visual.all("material"):
            if color := _rgb(material) or colors.get(material.attributes.get("name", "")):
                return color
    return GREY


def _rgb(material: Element) -> Color | None:
    color = material.child("color")
    return color.color("rgba") if color else None
