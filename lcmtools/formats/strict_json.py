"""Strict JSON, written in one place. Numbers that JSON lacks are the texts "nan", "inf" and "-inf".

A number is never null: a reader can tell NaN from a missing value, and publish it again.
"""

import math
import re
from collections.abc import Mapping

# Legal in JSON, but in YAML forbidden or a line's end; JSON written here must be valid YAML too.
# Surrogates stand for bytes that are not UTF-8; others change the text direction of terminals.
_ESCAPED = re.compile("[\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff\ufffe\uffff]")


def write_json(value: object, *, indent: int | None = None) -> str:
    """Return a value as JSON that is also YAML: compact on one line, or as indented lines."""
    separators = (",", ":") if indent is None else (",", ": ")
    try:
        text = _dumps(value, indent, separators)
    except ValueError:
        text = _dumps(finite(value), indent, separators)
    return _ESCAPED.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def finite(value: object) -> object:
    """Return a value in which infinities and NaN are texts."""
    if isinstance(value, float):
        return value if math.isfinite(value) else str(float(value))
    if isinstance(value, Mapping):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return value


def _dumps(value: object, indent: int | None, separators: tuple[str, str]) -> str:
    import json  # commands that print text do without

    return json.dumps(
        value, allow_nan=False, ensure_ascii=False, indent=indent, separators=separators
    )
