"""JSON as the same plain values that YAML gives: every scalar stays text.

Belongs here: JSON's own reading, which is far faster than YAML's and knows its escapes (two
of four digits each for one character). Must not know messages.
"""

import re

from lcmtools.messages.plain import Value

_LITERALS = re.compile(r"\b(?:true|false)\b")


def read_json(text: str) -> tuple[bool, Value]:
    """Whether a text is one object or array of JSON, and its value.

    What is almost JSON is none: the YAML parser takes it, or says what is wrong and where.
    """
    import json

    if not text.lstrip().startswith(("{", "[")):
        return False, None
    try:
        value: Value = json.loads(
            text,
            parse_float=str,
            parse_int=str,
            parse_constant=str,
            object_pairs_hook=_without_twins,
        )
        return True, _as_text(value) if _LITERALS.search(text) else value
    except (ValueError, RecursionError):
        return False, None


def _without_twins(pairs: list[tuple[str, Value]]) -> dict[str, Value]:
    """The object; a key that is given twice is for the YAML parser to name."""
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError
    return found


def _as_text(value: Value) -> Value:
    """The value with true and false as text, which the type of a field reads."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return {name: _as_text(part) for name, part in value.items()}
    return [_as_text(part) for part in value] if isinstance(value, list) else value
