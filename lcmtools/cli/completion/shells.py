"""The requests and answers of bash, zsh and fish, with their quoting.

A request (the shell's name is in the environment variable _LCMTOOLS_COMPLETE):

    bash  the line up to the cursor, and $COMP_WORDBREAKS
    zsh   the words before, as typed; the quote that the word begins with; the word behind it
    fish  the words before, without quotes; the word, as typed

The answer, a line each:

    bash  "files", "open" or "closed"; then the replacement of the word's last part
    zsh   "files", or: "open" or "closed", TAB, the replacement, TAB, the text shown
    fish  "files", or: the word without quotes, TAB, its help
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from lcmtools.cli.completion.situation import Candidate

_PLAIN = re.compile(r"[\w@%+=:,./-]+", re.ASCII)
_PLAIN_IN_BASH = re.compile(r"[\w@%+=:,./\[\]-]+", re.ASCII)  # no file is named as a field path is
_HELP_LENGTH = 70
_ACTIVE_IN_DOUBLE_QUOTES = frozenset('"$`\\!')
_ENDS = re.compile(r"[|;&\n(]")  # of a command


@dataclass(frozen=True, slots=True)
class Request:
    """A request for the candidates of a word.

    Attributes:
        words: The words before the cursor's, without the program's name and quotes.
        word: The part of the cursor's word that is typed, without quotes.
        quote: The quote that is open at the cursor; "" for none.
        kept: The part of the word that stays as it is typed: the shell puts the answer behind it.
    """

    words: Sequence[str]
    word: str
    quote: str = ""
    kept: str = ""


@dataclass(frozen=True, slots=True)
class Shell:
    """Reads a shell's requests and writes its answers."""

    read: Callable[[Sequence[str]], Request]
    write: Callable[[Sequence[Candidate], Request], list[str]]


def _read_bash(arguments: Sequence[str]) -> Request:
    line, breaks = (*arguments, "", "")[:2]
    *before, last = scan(line, breaks.strip(" \t\n\"'") or "\n")
    return Request([word.text for word in before[1:]], last.text, last.quote, last.kept)


def _read_zsh(arguments: Sequence[str]) -> Request:
    *before, quote, word = arguments
    words = [unquoted(one) for one in before]
    return Request(words, unquoted(f"{quote}{word}"), quote if quote in ("'", '"') else "")


def _read_fish(arguments: Sequence[str]) -> Request:
    *words, word = arguments
    return Request(words, unquoted(word))


def _write_bash(candidates: Sequence[Candidate], request: Request) -> list[str]:
    is_open = len(candidates) == 1 and candidates[0].is_open
    rest = [one.value[len(request.kept) :] for one in candidates]
    answers = [_quoted(one, request.quote, _PLAIN_IN_BASH) for one in rest]
    return ["open" if is_open else "closed", *answers]


def _write_zsh(candidates: Sequence[Candidate], request: Request) -> list[str]:
    return [
        "\t".join(
            (
                "open" if one.is_open else "closed",
                _quoted(one.value, request.quote, _PLAIN),
                f"{one.value}  -- {one.help[:_HELP_LENGTH]}" if one.help else one.value,
            )
        )
        for one in candidates
    ]


def _write_fish(candidates: Sequence[Candidate], request: Request) -> list[str]:
    """As fish puts no blank behind a few characters only, an open word comes twice at need."""
    del request
    if len(candidates) == 1 and candidates[0].is_open and candidates[0].value[-1] not in "/=:.":
        candidates = [candidates[0], Candidate(f"{candidates[0].value}.")]
    return [f"{one.value}\t{one.help[:_HELP_LENGTH]}".rstrip("\t") for one in candidates]


def _quoted(text: str, quote: str, plain: re.Pattern[str]) -> str:
    """A text as it has to be typed behind an open quote; ``plain`` texts need no quotes."""
    if quote == '"':
        escaped = re.sub(r'([$`"\\])', r"\\\1", text)
        return escaped.replace("!", "\"'!'\"")  # between double quotes it would recall a command
    if quote == "'":
        return text.replace("'", "'\\''")
    if not text or plain.fullmatch(text):
        return text
    if not _ACTIVE_IN_DOUBLE_QUOTES.intersection(text):
        return f'"{text}"'
    return "'{}'".format(text.replace("'", "'\\''"))


SHELLS = {
    "bash": Shell(_read_bash, _write_bash),
    "zsh": Shell(_read_zsh, _write_zsh),
    "fish": Shell(_read_fish, _write_fish),
}


@dataclass(slots=True)
class Word:
    """A word of a typed line.

    Attributes:
        text: Without its quotes.
        quote: The quote that is open at its end; "" for none.
        kept: The part of ``text`` before the one that the shell would replace.
        is_begun: True if something was typed of it, if only a quote.
    """

    text: str = ""
    quote: str = ""
    kept: str = ""
    is_begun: bool = False


@dataclass(slots=True)
class _Scanner:
    """The words so far, the last of which goes on."""

    breaks: str
    words: list[Word] = field(default_factory=lambda: [Word()])

    def take(self, character: str, following: str) -> int:
        """Take the next character, and the following one if it is escaped; return how many."""
        word = self.words[-1]
        if character == "\\" and word.quote != "'" and following:
            is_kept = word.quote and following not in _ACTIVE_IN_DOUBLE_QUOTES
            word.text += f"\\{following}" if is_kept else following
            word.is_begun = True
            return 2
        if word.quote:
            self._within_quotes(word, character)
        else:
            self._outside(word, character)
        return 1

    def _within_quotes(self, word: Word, character: str) -> None:
        if character == word.quote:
            word.quote = ""
        else:
            word.text += character

    def _outside(self, word: Word, character: str) -> None:
        if character in "'\"":
            word.quote, word.kept, word.is_begun = character, word.text, True
        elif character in " \t":
            if word.is_begun:
                self.words.append(Word())
        elif self.breaks and _ENDS.match(character):
            self.words = [Word()]
        else:
            word.text, word.is_begun = word.text + character, True
            if character in self.breaks:
                word.kept = word.text


def scan(line: str, breaks: str = "") -> list[Word]:
    """Return the words of the last command in a line; the last one is at the line's end.

    The rules are those that bash, zsh and fish share; a quote may still be open. What a shell
    would expand ($HOME, `date`) stays as it is.

    Args:
        line: As typed, up to the cursor.
        breaks: Characters behind which the shell goes on, as bash has them in COMP_WORDBREAKS; ""
            for one word, in which nothing ends a command.
    """
    scanner = _Scanner(breaks)
    position = 0
    while position < len(line):
        position += scanner.take(line[position], line[position + 1 : position + 2])
    return scanner.words


def unquoted(typed: str) -> str:
    """Return one word as the command receives it; a quote may be open."""
    return scan(typed)[-1].text
