"""The entry point of completion, for the request that a shell makes at TAB.

It is silent whatever happens: nothing may be printed into the prompt. With LCMTOOLS_DEBUG set,
errors go to a file. A request (the shell's name is in the environment variable _LCMTOOLS_COMPLETE):

    bash  the line up to the cursor, and $COMP_WORDBREAKS
    zsh   the words before, as typed; the quote that the word begins with; the word behind it
    fish  the words before, without quotes; the word, as typed

The answer, a line each:

    bash  "files", "open" or "closed"; then the replacement of the word's last part
    zsh   "files", or: "open" or "closed", TAB, the replacement, TAB, the text shown
    fish  "files", or: the word without quotes, TAB, its help
"""

import contextlib
import os
import re
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from lcmtools.cli.completion.line import locate
from lcmtools.cli.completion.situation import FILES, Candidate, Situation, candidates
from lcmtools.cli.completion.tree import describe
from lcmtools.escapes import ESCAPES

_PLAIN = re.compile(r"[\w@%+=:,./-]+", re.ASCII)
_PLAIN_IN_BASH = re.compile(r"[\w@%+=:,./\[\]-]+", re.ASCII)  # no file has the name of a field path
_HELP_LENGTH = 70
_ACTIVE_IN_DOUBLE_QUOTES = frozenset('"$`\\!')
_ENDS = re.compile(r"[|;&\n(]")  # of a command
_ESCAPED = re.compile(r'\\(["$`\\!])')
_PIECE = re.compile(
    r"""[ \t]+|'(?P<single>[^']*)(?P<end>'?)|"(?P<double>(?:\\.|[^"])*)(?P<end2>"?)"""
    r"""|\\(?P<escaped>.)|.""",
    re.DOTALL,
)


class Request(NamedTuple):
    """A request for the candidates of a word; the words are without quotes."""

    words: Sequence[str]  # before the cursor's, without the program's name
    word: str  # as far as it is typed
    quote: str = ""  # the one that is open at the cursor
    kept: str = ""  # the part of the word that the shell puts the answer behind


class Shell(NamedTuple):
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
    rows = []
    for one in candidates:
        shown = f"{one.value}  -- {one.help[:_HELP_LENGTH]}" if one.help else one.value
        answer = _quoted(one.value, request.quote, _PLAIN)
        rows.append(f"{'open' if one.is_open else 'closed'}\t{answer}\t{shown}")
    return rows


def _write_fish(candidates: Sequence[Candidate], request: Request) -> list[str]:
    """As fish puts no blank behind a few characters only, an open word comes twice at need."""
    del request
    if len(candidates) == 1 and candidates[0].is_open and candidates[0].value[-1] not in "/=:.":
        candidates = [candidates[0], Candidate(f"{candidates[0].value}.")]
    return [f"{one.value}\t{one.help[:_HELP_LENGTH]}".rstrip("\t") for one in candidates]


def _quoted(text: str, quote: str, plain: re.Pattern[str]) -> str:
    """Quote a text for an open quote. A ``plain`` text needs no quotes."""
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


class Word:
    """A word of a typed line."""

    def __init__(self) -> None:
        self.text = ""  # without its quotes
        self.quote = ""  # the one that is open at its end
        self.kept = ""  # the part of text before the one that the shell would replace
        self.is_begun = False  # something was typed of it, if only a quote


def scan(line: str, breaks: str = "") -> list[Word]:
    """Return the words of the last command in a line, up to the end of the line.

    The rules are those that bash, zsh and fish share; a quote may still be open. What a shell
    would expand ($HOME, `date`) stays as it is. Behind the characters in ``breaks`` the shell goes
    on, as bash has them in COMP_WORDBREAKS; "" is for one word, in which nothing ends a command.
    """
    words = [Word()]
    for found in _PIECE.finditer(line):
        word, piece = words[-1], found[0]
        if piece[0] in " \t":
            words += [Word()] if word.is_begun else []
        elif breaks and _ENDS.match(piece):
            words = [Word()]
        else:
            quote = piece[0] if piece[0] in "'\"" else ""
            word.quote = "" if found["end"] or found["end2"] else quote
            word.kept = word.text if quote else word.kept
            word.text += _text_of(found)
            word.kept = word.text if piece in breaks else word.kept
            word.is_begun = True
    return words


def _text_of(found: re.Match[str]) -> str:
    if found["double"] is not None:
        return _ESCAPED.sub(r"\1", found["double"])
    return next((text for text in found.group("single", "escaped") if text is not None), found[0])


def unquoted(typed: str) -> str:
    """Return a word as the command receives it. A quote may be open."""
    return scan(typed)[-1].text


VARIABLE = "_LCMTOOLS_COMPLETE"  # the environment variable that names the requesting shell
_LATEST = 2.0  # [s] after which the process ends whatever delays it


def run() -> None:
    """Answer the request on the command line, and end the process."""
    _be_silent()
    try:
        lines = answer(os.environ[VARIABLE], sys.argv[1:])
        with contextlib.suppress(OSError):
            os.write(1, "".join(f"{line}\n" for line in lines).encode("utf-8", "surrogateescape"))
    except BaseException:  # noqa: BLE001 - a prompt is no place for any of them
        _log()
    os._exit(0)  # without waiting for anything


def answer(shell: str, arguments: Sequence[str]) -> list[str]:
    """Return the lines for a shell, or [] for an unknown one."""
    if shell not in SHELLS:
        return []
    request = SHELLS[shell].read(arguments)
    found = _complete(request, os.environ)
    fitting = shown(found, request.word)
    if not fitting and any(one is FILES for one in found):
        return ["files"]
    return SHELLS[shell].write(fitting, request)


def _complete(request: Request, environment: Mapping[str, str]) -> list[Candidate]:
    """Return candidates for the word at the cursor. Some may not begin with its typed part."""
    place = locate(request.words, request.word, describe)
    if place is None:
        return []
    if place.kind == "commands":
        return [Candidate(name, text) for name, text in place.command.commands.items()]
    if place.kind == "options":  # long forms first
        ranked = [(name, one.help) for one in place.unused_options() for name in one.names]
        ranked.sort(key=lambda pair: not pair[0].startswith("--"))
        return [Candidate(*pair) for pair in ranked]
    if ":" in place.source:  # a function, which may look up types
        from lcmtools.packages import provide_user_types

        provide_user_types()
    word = request.word[len(place.before) :]
    found = candidates(place.source, Situation(word, place.given, environment))
    return [
        one if one is FILES else Candidate(f"{place.before}{one.value}", one.help, one.is_open)
        for one in found
    ]


def shown(found: Sequence[Candidate], word: str) -> list[Candidate]:
    """Return the candidates that begin with the typed word, without duplicates.

    A name with control characters, as a channel may have, is no candidate: the terminal would obey
    it, or the shell take it for a line of its own. In a help, as of a node, they are escaped.
    """
    fitting = {
        one.value: one._replace(help=one.help.translate(ESCAPES).replace("\t", " "))
        for one in reversed(found)
        if one is not FILES and one.value.startswith(word) and one.value.isprintable()
    }
    return list(reversed(fitting.values()))


def _be_silent() -> None:
    """Keep everything from the terminal, and end the process in time."""
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 2)
    signal.signal(signal.SIGALRM, lambda *_: os._exit(0))
    signal.setitimer(signal.ITIMER_REAL, _LATEST)
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))


def _log() -> None:
    import traceback

    from lcmtools.folders import home_folder

    folder = home_folder(os.environ, "XDG_STATE_HOME", ".local/state")
    if folder is None or not os.environ.get("LCMTOOLS_DEBUG"):
        return
    with contextlib.suppress(OSError):
        (folder / "lcmtools").mkdir(parents=True, exist_ok=True)
        with (folder / "lcmtools" / "completion.log").open("a", encoding="utf-8") as log:
            log.write(f"{time.strftime('%F %T')} {sys.argv[1:]}\n{traceback.format_exc()}\n")
