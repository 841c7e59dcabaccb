"""What bash, zsh and fish hand over, and how each wants the answer: their quoting is here.

What a shell asks (its name is in the environment variable _LCMTOOLS_COMPLETE):

    bash  the line up to the cursor, and $COMP_WORDBREAKS
    zsh   the words before, as typed; the quote that the word begins with; the word behind it
    fish  the words before, without quotes; the word, as typed

What it gets, a line each:

    bash  "files", "open" or "closed"; then what is to stand in place of the word's last part
    zsh   "files", or: "open" or "closed", TAB, what is to stand there, TAB, what is shown
    fish  "files", or: the word without quotes, TAB, its help
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.typed import ACTIVE_IN_DOUBLE_QUOTES, scan, unquoted

_PLAIN = re.compile(r"[\w@%+=:,./-]+", re.ASCII)
_PLAIN_IN_BASH = re.compile(r"[\w@%+=:,./\[\]-]+", re.ASCII)  # no file is named as a field path is
_HELP_LENGTH = 70


@dataclass(frozen=True, slots=True)
class Question:
    """What a shell wants to know.

    Attributes:
        words: The words before the cursor's, without the program's name and quotes.
        word: What is typed of the cursor's word, without quotes.
        quote: The quote that is open at the cursor; "" for none.
        kept: The part of the word that stays as it is typed, because the shell puts its answer
            behind that.
    """

    words: Sequence[str]
    word: str
    quote: str = ""
    kept: str = ""


@dataclass(frozen=True, slots=True)
class Shell:
    """How one shell asks, and what it understands."""

    read: Callable[[Sequence[str]], Question]
    write: Callable[[Sequence[Candidate], Question], list[str]]


def _read_bash(arguments: Sequence[str]) -> Question:
    line, breaks = (*arguments, "", "")[:2]
    *before, last = scan(line, breaks.strip(" \t\n\"'") or "\n")
    return Question([word.text for word in before[1:]], last.text, last.quote, last.kept)


def _read_zsh(arguments: Sequence[str]) -> Question:
    *before, quote, word = arguments
    words = [unquoted(one) for one in before]
    return Question(words, unquoted(f"{quote}{word}"), quote if quote in ("'", '"') else "")


def _read_fish(arguments: Sequence[str]) -> Question:
    *words, word = arguments
    return Question(words, unquoted(word))


def _write_bash(candidates: Sequence[Candidate], question: Question) -> list[str]:
    is_open = len(candidates) == 1 and candidates[0].is_open
    rest = [one.value[len(question.kept) :] for one in candidates]
    answers = [_quoted(one, question.quote, _PLAIN_IN_BASH) for one in rest]
    return ["open" if is_open else "closed", *answers]


def _write_zsh(candidates: Sequence[Candidate], question: Question) -> list[str]:
    return [
        "\t".join(
            (
                "open" if one.is_open else "closed",
                _quoted(one.value, question.quote, _PLAIN),
                f"{one.value}  -- {one.help[:_HELP_LENGTH]}" if one.help else one.value,
            )
        )
        for one in candidates
    ]


def _write_fish(candidates: Sequence[Candidate], question: Question) -> list[str]:
    """As fish puts no blank behind a few characters only, an open word comes twice at need."""
    del question
    if len(candidates) == 1 and candidates[0].is_open and candidates[0].value[-1] not in "/=:.":
        candidates = [candidates[0], Candidate(f"{candidates[0].value}.")]
    return [f"{one.value}\t{one.help[:_HELP_LENGTH]}".rstrip("\t") for one in candidates]


def _quoted(text: str, quote: str, plain: re.Pattern[str]) -> str:
    """A text as it has to be typed, so that the shell leaves it whole.

    Args:
        text: As the command is to get it.
        quote: The quote that is open before it; "" for none.
        plain: What needs no quotes.
    """
    if quote == '"':
        escaped = re.sub(r'([$`"\\])', r"\\\1", text)
        return escaped.replace("!", "\"'!'\"")  # between double quotes it would recall a command
    if quote == "'":
        return text.replace("'", "'\\''")
    if not text or plain.fullmatch(text):
        return text
    if not ACTIVE_IN_DOUBLE_QUOTES.intersection(text):
        return f'"{text}"'
    return "'{}'".format(text.replace("'", "'\\''"))


SHELLS = {
    "bash": Shell(_read_bash, _write_bash),
    "zsh": Shell(_read_zsh, _write_zsh),
    "fish": Shell(_read_fish, _write_fish),
}
