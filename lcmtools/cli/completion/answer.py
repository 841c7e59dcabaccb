"""The entry point of completion, for the request that a shell makes at TAB.

It is silent whatever happens: nothing may be printed into the prompt. With LCMTOOLS_DEBUG set,
errors go to a file.
"""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Mapping, Sequence

from lcmtools.cli.completion.line import locate
from lcmtools.cli.completion.shells import SHELLS, Request
from lcmtools.cli.completion.situation import FILES, Candidate, Situation, candidates
from lcmtools.cli.completion.tree import describe
from lcmtools.escapes import ESCAPES

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
    """Return the lines for a shell, or [] for an unknown one. See ``shells``."""
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
