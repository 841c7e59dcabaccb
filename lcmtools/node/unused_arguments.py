"""Words of a command line that have no effect on a program's nodes, explained in one line each.

Belongs here: the texts. Must not know nodes or the bus.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from lcmtools.arguments import NodeArguments, looks_special, misspelt
from lcmtools.names import did_you_mean

_SPECIAL = ("ns", "name")


@dataclass(slots=True)
class UsedNames:
    """The names in the code of a program's nodes, and what its command line has besides names."""

    words: Sequence[str] = ()
    """The words up to ``--`` that are no names: most are the program's own."""
    parameters: set[str] = field(default_factory=set)
    topics: dict[str, str] = field(default_factory=dict)
    """Topics and services as in the code, by their full names before remaps."""
    remaps: set[str] = field(default_factory=set)
    """The remaps that applied, by their first names as typed."""


def unused(
    arguments: NodeArguments, used: UsedNames, expand: Callable[[str], str]
) -> Iterator[str]:
    """Yield a warning for each parameter and remap that no node uses, and each misspelt one.

    ``expand`` returns the full name of a topic before remaps.
    """
    for name in arguments.parameters.keys() - used.parameters:
        special = "did you mean __ns:= or __name:=?" if name in _SPECIAL else ""
        yield _line(
            f"there is no parameter '{name}'", did_you_mean(name, used.parameters) or special
        )
    for source, target in arguments.remaps:
        if source not in used.remaps:
            what = f"{source}:={target} has no effect: no topic or service here is named '{source}'"
            yield _line(what, did_you_mean(source, used.topics.values()))
    for word in used.words:
        if not looks_special(word) and (hint := _meant(word, used, expand)):
            yield _line(f"'{word}' names nothing", hint)


def _meant(word: str, used: UsedNames, expand: Callable[[str], str]) -> str:
    """Return the hint for a word such as "chatter=news", which may be the program's own, or ""."""
    said = misspelt(used.words, word).removeprefix("did you mean ").removesuffix("?")
    name, _, value = said.partition(":=")
    if (bare := name.lstrip("_")) in used.parameters:
        return f"did you mean _{bare}:={value}?"
    is_name = word[0] in "_~/" or (name[:1].isalpha() and expand(name) in used.topics)
    return f"did you mean {said}?" if name and is_name else ""


def _line(what: str, hint: str) -> str:
    return f"{what}; {hint}" if hint else what
