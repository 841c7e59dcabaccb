"""A picture in words: its size, encoding, and how far away things are. Pure."""

from collections.abc import Mapping
from itertools import chain

from lcmtools.labs.nodes.picture.pixels import Kind, Picture
from lcmtools.labs.nodes.picture.shades import Scale


def facts(picture: Picture) -> dict[str, object]:
    """What there is to say: size, encoding, and min, max and middle in m, or in grey.

    None stands for no reading.
    """
    known: dict[str, object] = {
        "width": picture.width,
        "height": picture.height,
        "encoding": picture.encoding,
    }
    kind = picture.layout.kind
    if kind is Kind.COLOR:
        return known
    middle = picture.row(picture.height // 2, [picture.width // 2])[0]
    values = set(chain.from_iterable(picture.row(y) for y in range(picture.height)))
    if kind is Kind.DEPTH:
        values.discard(0)
    numbers = [value for value in values if isinstance(value, int)]
    for name, value in (
        ("min", min(numbers, default=None)),
        ("max", max(numbers, default=None)),
        ("middle", middle if kind is Kind.GREY or middle else None),
    ):
        is_length = kind is Kind.DEPTH and isinstance(value, int)
        known[name] = value / 1000 if is_length and isinstance(value, int) else value
    return known


def sentence(known: Mapping[str, object]) -> str:
    """The facts in one line."""
    size = f"{known['width']} x {known['height']} {known['encoding']}"
    if "min" not in known:
        return size
    parts = [f"{name} {_value(known[name])}" for name in ("min", "max", "middle")]
    return f"{size}  {'  '.join(parts)}"


def legend_ends(scale: Scale) -> tuple[str, str]:
    """A depth scale's ends."""
    return f"{scale.near / 1000:g} m", f"{scale.far / 1000:g} m"


def _value(value: object) -> str:
    if value is None:
        return "none"
    return f"{value:.2f} m" if isinstance(value, float) else str(value)
