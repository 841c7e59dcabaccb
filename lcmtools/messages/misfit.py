"""A value that does not fit its field, while the path to the field is still being found.

Belongs here: how such an error gathers its path on the way up, so that values that do fit cost
nothing. Must not know what fits; it never leaves this room, users see ValueMismatch.
"""

from lcmtools.errors import ValueMismatch

_LONGEST = 40
"""Characters of a value that an error line repeats."""


class Misfit(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """A value that does not fit.

    Attributes:
        what: What was expected and what was given.
        hint: What to write instead, or "".
    """

    def __init__(self, what: str, hint: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint
        self._steps: list[str] = []

    def inside(self, step: str) -> None:
        """Note the field (".name") or the array element ("[3]") that the error rises out of."""
        self._steps.append(step)

    def mismatch(self, root: str) -> ValueMismatch:
        """The error for the user; ``root`` is the type's name, said when the path is empty."""
        path = "".join(reversed(self._steps)).removeprefix(".")
        says_root = not path and self.what.startswith(f"{root} ")
        return ValueMismatch(self.what if says_root else f"{path or root}: {self.what}", self.hint)


def given(value: object) -> str:
    """A short description of a given value for an error line."""
    if value is None:
        return "nothing"
    if isinstance(value, (list, tuple)):
        return "a list"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, (bytes, bytearray)):
        return "binary data"
    if isinstance(value, (bool, int, float, str)):
        text = repr(value)
        return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 4]}...{text[-1]}"
    return f"a {type(value).__name__}"
