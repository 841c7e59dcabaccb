"""A command line as it is typed: its words without quotes, and where the shell would go on.

The rules are those that bash, zsh and fish share; a quote may still be open. What a shell would
expand ($HOME, `date`) stays as it is.
"""

import re
from dataclasses import dataclass, field

ACTIVE_IN_DOUBLE_QUOTES = frozenset('"$`\\!')
"""What a shell acts upon between double quotes."""
_ENDS = re.compile(r"[|;&\n(]")


@dataclass(slots=True)
class Word:
    """A word.

    Attributes:
        text: Without its quotes.
        quote: The quote that is open at its end; "" for none.
        kept: The part of ``text`` before what the shell would replace.
        is_begun: Something was typed of it, if only a quote.
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
        """Take what comes next; how many characters that was."""
        word = self.words[-1]
        if character == "\\" and word.quote != "'" and following:
            is_kept = word.quote and following not in ACTIVE_IN_DOUBLE_QUOTES
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
    """The words of a line, of the last command in it; the last one is where the line ends.

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
    """One word as the command gets it; a quote may be open."""
    return scan(typed)[-1].text
