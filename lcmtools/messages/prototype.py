"""A message to fill in: every field of a type with its default, as ``rosmsg-proto`` writes it.

Belongs here: how plain values are laid out as a block of YAML that ``pub`` takes. Must not know
where the text goes.

    linear:
      x: 0.0
    covariance: [0.0, 0.0]
    name: []
    frame_id: ''
"""

from collections.abc import Iterator, Mapping

from lcmtools.messages.plain import Plain, to_plain
from lcmtools.messages.registry import Message
from lcmtools.messages.text import quoted


def prototype(cls: type[Message]) -> str:
    """The fields of a type with their defaults, as YAML; "{}" for a type without fields."""
    return "\n".join(_rows(to_plain(cls()), "")) or "{}"


def _rows(fields: Mapping[str, Plain], indent: str) -> Iterator[str]:
    for name, value in fields.items():
        if isinstance(value, dict) and value:
            yield f"{indent}{name}:"
            yield from _rows(value, f"{indent}  ")
        else:
            yield f"{indent}{name}: {_inline(value)}"


def _inline(value: Plain) -> str:
    """A value in one line; whole messages only stand here within arrays of fixed size."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name}: {_inline(part)}' for name, part in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return quoted(value) if isinstance(value, str) else repr(value)
